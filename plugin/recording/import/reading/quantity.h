#pragma once
// What a column of an export measures and in which unit, from its heading.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace supercircle::importing {

/// Counter: rows numbered by the machine.
enum class Quantity : std::uint8_t {
    None,
    Time,
    Displacement,
    Force,
    Angle,
    MarkerX,
    MarkerY,
    Counter,
    Velocity,
    AngularVelocity
};

const char* name(Quantity quantity);

/// A unit of measurement.
struct Unit {
    std::string name; ///< as it is usually written
    Quantity measures =
        Quantity::None;  ///< Time, Displacement (any length), Force, Angle, a velocity; None: no unit we know
    double factor = 1.0; ///< value in SI = value * factor
};

/// "kN", "[mm]", "(N)", "in", "Sek.": measures == None if it is no unit we know. Lengths count as Displacement.
/// Capitals count where they make another unit: N, m, nm, mN, MN, ms.
Unit unitOf(std::string_view text);

/// A heading taken apart.
struct Heading {
    std::string text; ///< as it stands in the file
    Quantity quantity = Quantity::None;
    std::string marker; ///< name of the marker
    Unit unit;
    bool unitStated = false;
    bool other = false;      ///< its words name something else: a stress, a rate, a cycle
    bool byUnit = false;     ///< its words are not known: the unit alone says what it is
    std::string unknownUnit; ///< what stands in the unit's place but is none
    bool twoUnits = false;   ///< these are two that contradict each other: in the name, and on the line of units
    int rank = 0;            ///< how sure: of several columns of one quantity the one with the highest rank is taken
};

/// From the name of a column and, if there is a line of units, its unit (which wins over one in the name).
Heading headingOf(std::string_view columnName, std::string_view unitCell);

/// The unit that is assumed where none is stated: s, mm, N, deg.
Unit usualUnit(Quantity quantity);

} // namespace supercircle::importing
