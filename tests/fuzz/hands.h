#pragma once
// The monkey's hands: random calls of everything that holds, joins, pulls and changes shells.

#include "plugin/api/include/supercircle/shells.hpp"
#include "tests/fuzz/tape.h"

#include <string>

namespace supercircle::fuzz {

class Hands {
public:
    /// What a call may be made on.
    struct Subjects {
        ShellHandle a, b;
        BodyId body = 0;
    };
    struct Made {
        bool done = false;
        const char* what = "";
    };
    /// Makes one call.
    Made act(Shells& shells, Tape& tape, const Subjects& on);

private:
    Made tie(Shells& shells, Tape& tape, const Subjects& on);
    Made move(Shells& shells, Tape& tape);
    Made push(Shells& shells, Tape& tape, const Subjects& on);
    Made change(Shells& shells, Tape& tape, const Subjects& on);

    std::vector<HoldHandle> holds_;
    std::vector<JointHandle> joints_;
    std::vector<GrabHandle> grabs_;
    std::vector<ForceHandle> forces_;
};

} // namespace supercircle::fuzz
