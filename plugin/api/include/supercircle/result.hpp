#pragma once
// How a call answers: with a value, or with the reason why there is none. Reading the value of a failed Result calls
// the failure handler, which set_failure_handler() replaces.

#include "supercircle/support/result.h" // the one core header that a public header includes
