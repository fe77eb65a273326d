#pragma once
// Problems of input files: what is wrong, where, and how to correct it. A reader goes on after an error, so that one
// run shows all of them. It therefore fills a list of problems beside its Result, whose error is their text.

#include <cstddef>
#include <string>
#include <vector>

namespace supercircle::scene {

/// One thing wrong (or, as a note, worth knowing) in an input file.
struct Problem {
    enum class Severity { Error, Note };
    std::string file;
    int line = 0;         ///< from 1; 0: the file as a whole
    int column = 0;       ///< from 1, in characters (code points)
    std::string pointer;  ///< JSON pointer (RFC 6901) of the offending key or value
    std::string what;     ///< what is wrong
    std::string expected; ///< what would have been right; may be empty
    std::string nearest;  ///< nearest known name; may be empty
    Severity severity = Severity::Error;

    /// `file:line:column: /pointer: what; expected ...; did you mean "..."?`
    [[nodiscard]] std::string toString() const;
};

/// True if at least one of them is an error.
[[nodiscard]] bool anyError(const std::vector<Problem>& problems);

/// Their errors from index `first` on, one a line, without the notes: the error of a Result.
[[nodiscard]] std::string errorText(const std::vector<Problem>& problems, std::size_t first = 0);

} // namespace supercircle::scene
