#pragma once
// Random calls that create, change and destroy holds, joints, forces and properties of shells.

#include "plugin/api/include/supercircle/shells.hpp"
#include "tests/fuzz/byte_source.h"

#include <string>

namespace supercircle::fuzz {

class ShellActions {
public:
    /// The objects of a call.
    struct Subjects {
        ShellHandle a, b;
        BodyId body = 0;
    };
    struct CallResult {
        bool done = false;
        const char* what = "";
    };
    /// Makes one call.
    CallResult act(Shells& shells, ByteSource& bytes, const Subjects& on);

private:
    CallResult constrain(Shells& shells, ByteSource& bytes, const Subjects& on);
    CallResult setTargets(Shells& shells, ByteSource& bytes);
    CallResult applyForces(Shells& shells, ByteSource& bytes, const Subjects& on);
    CallResult changeProperties(Shells& shells, ByteSource& bytes, const Subjects& on);

    std::vector<HoldHandle> holds_;
    std::vector<JointHandle> joints_;
    std::vector<MouseJointHandle> mouseJoints_;
    std::vector<ForceHandle> forces_;
};

} // namespace supercircle::fuzz
