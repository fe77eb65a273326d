#pragma once
// Solved reference curves: CSV with '#' comments, a header line and numbers, in units of R and B (or L and B).

#include <map>
#include <string>
#include <vector>

namespace supercircle::validation {

/// A reference file. Header names may contain commas inside parentheses ("bc(0 free-free,1 clamped-free)"), and the
/// first column may contain text.
class ReferenceTable {
public:
    /// Reads DIR/NAME; throws std::runtime_error with file and line where it cannot.
    ReferenceTable(const std::string& directory, const std::string& name);

    [[nodiscard]] std::size_t rows() const { return labels_.size(); }
    /// Throws if there is no such column.
    [[nodiscard]] const std::vector<double>& column(const std::string& name) const;
    [[nodiscard]] double at(std::size_t row, const std::string& name) const { return column(name)[row]; }
    /// Text of the first column.
    [[nodiscard]] const std::string& label(std::size_t row) const { return labels_[row]; }

private:
    std::string file_;
    std::map<std::string, std::vector<double>> columns_;
    std::vector<std::string> labels_;
};

} // namespace supercircle::validation
