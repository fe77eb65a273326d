#pragma once
// The parts of a scene file, each read by its own function; private to the loader.

#include "plugin/scene/loader/reader.h"
#include "plugin/scene/loader/scene.h"

namespace supercircle::scene {

/// The R.U.B.E. / b2dJson part of the top level: gravity, body[], joint[]. Keys of R.U.B.E. without effect get a note.
void readRigid(Context& context, ObjectReader& top, step::RigidWorldDefinition& out);
/// joint[]; the bodies must have been read.
void readJoints(Context& context, ObjectReader& top, step::RigidWorldDefinition& out);

/// One shell; `isTemplate` is true for the shell of a drop, which has no position.
ShellDef readShell(Context& context, const Node& node, const std::string& pointer, bool isTemplate);
void readShells(Context& context, ObjectReader& top, std::vector<ShellDef>& out);
/// hold[]; the shells must have been read.
void readHolds(Context& context, ObjectReader& top, const std::vector<ShellDef>& shells, std::vector<HoldDef>& out);
/// load[] and start; the shells must have been read.
void readLoads(Context& context, ObjectReader& top, Scene& scene);
void readDrop(Context& context, ObjectReader& top, std::optional<Drop>& out);

/// protocol; bodies and holds must have been read.
void readProtocol(Context& context, ObjectReader& top, const Scene& scene, std::optional<Protocol>& out);
/// observe[]; bodies, shells and protocol must have been read.
void readObservations(Context& context, ObjectReader& top, Scene& scene);
/// effects[]; call it after shells, holds, bodies and protocol.
void readEffects(Context& context, ObjectReader& top, Scene& scene);
void readNumerics(Context& context, ObjectReader& top, Numerics& out);
void readReport(Context& context, ObjectReader& top, Report& out);

/// game; bodies must have been read.
void readGame(Context& context, ObjectReader& top, const Scene& scene, std::optional<Game>& out);

/// Values of report.kind.
const std::vector<std::string>& reportKinds();

} // namespace supercircle::scene
