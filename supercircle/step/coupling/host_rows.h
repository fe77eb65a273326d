#pragma once
// Host bodies in the shells' contact problem (private to step/; the scheme is in host_coupling.h).
//
// Bodies that joints connect are one block of the problem, so that a joint is as stiff as the host makes it at no cost
// in the contact solver. A rigid row is a damper of 1e6 times the effective mass there: it slips by 1e-6 of the
// velocity it has to stop, and over-determined joints (two hinges of a door) need no care. Bodies the host only stacks
// on each other are blocks of their own with contact rows between them.

#include "supercircle/step/contacts/contact_rows.h"

namespace supercircle::step {

/// Puts the dynamic bodies among the candidates and links, and those that host contacts and joints connect to them,
/// into stage.problem as blocks. Fills stage.host.place and the ends of the constraints.
void addHostBlocks(const World& world, double dt, ContactStage& stage);

/// What an attempt starts from: stage.host.saturated.
void beginHostRows(const World& world, ContactStage& stage);

/// The same blocks with the rows as saturated as they are now; places and contacts of the problem stay.
void renewHostBlocks(const World& world, double dt, ContactStage& stage);

/// Finds the host's contact points and joint limits that take part: stage.host.entries.
void listHostContacts(const World& world, ContactStage& stage);

/// Fills the problem's contacts behind the candidates' and the links' with them, and their warm start.
void addHostContacts(const World& world, double dt, ContactStage& stage);

/// Writes the solution back into stage.host.motion.
void readHostBlocks(const World& world, ContactStage& stage);

/// Rigid rows whose solved force is beyond their strength go to it, in this attempt (stage.host.saturated). True if
/// there were any: renew the blocks and solve again.
bool boundHostRows(const World& world, double dt, ContactStage& stage);

/// After an accepted step: rooms, forces and saturation of the world's constraints.
void acceptHostConstraints(World& world, const ContactStage& stage, double dt);

/// Velocity of a dynamic body at the end of a step without shells, in Box2D's order of gravity, damping and
/// constraints; the constraints are `host` (m/s^2) and `hostSpin` (rad/s^2).
BodyMotion freeMotion(const World& world, const Body& b, const Vec2& host, double hostSpin, double dt);

using RowRef = Eigen::Ref<Eigen::RowVectorXd, 0, Eigen::InnerStride<>>;

/// Columns of body `i` in a row of its block: `row` (1 x block freedoms) += direction . v + turn w.
void addToRow(const ContactStage& stage, int body, const Vec2& direction, double turn, RowRef row);

} // namespace supercircle::step
