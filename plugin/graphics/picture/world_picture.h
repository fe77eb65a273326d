#pragma once
// The picture of a world from plain data: bodies, shells with their stored energy, contacts, holds and snaps. The look
// is decided here: dark ground, shells as bands with rim and highlight, dark outlines between nested shells, offset
// shadows, a flash with the released energy at a snap.

#include "plugin/graphics/picture/draw_list.h"
#include "plugin/graphics/picture/snap_marks.h"

#include <optional>
#include <vector>

namespace supercircle::picture {

/// Where the world is seen from. Lengths on the picture are pixels of the device.
struct View {
    double width = 800.0, height = 600.0; ///< px
    Point centre{};                       ///< of the picture, m
    double pixelsPerMetre = 100.0;
    double pixelRatio = 1.0;    ///< of line widths, marks and texts to their sizes on an ordinary screen, 1
    bool reducedMotion = false; ///< no flash, and texts of snaps stand still
    [[nodiscard]] Point pixel(Point metres) const {
        return {0.5 * width + pixelsPerMetre * (metres.x - centre.x),
                0.5 * height - pixelsPerMetre * (metres.y - centre.y)};
    }
};

enum class Role { Still, Driven, Loose };

struct Body {
    std::vector<Point> points{};   ///< corners in the world, m; one: a disc
    double radius = 0.0;           ///< of a disc, m
    std::optional<double> angle{}; ///< of a disc, rad: a line shows how it turns
    bool solid = true;             ///< false: an open line
    Role role = Role::Still;
    std::uint64_t id = 0;                 ///< pieces of one body have no edge between them if they follow each other
    std::optional<Colour> fill{}, edge{}; ///< instead of those of the role
};

struct Shell {
    std::vector<Point> line{};    ///< centre line, m
    std::vector<double> energy{}; ///< stored energy per length at each point, J/m
    double thickness = 0.0;       ///< m
    double fullEnergy = 1.0;      ///< stored energy per length that has the last colour, J/m
    bool closed = false;          ///< a ring: the last point is not the first one
    bool quarantined = false;
    std::optional<Colour> tint{};  ///< of a shell at rest, instead of the first colour
    std::vector<Colour> colours{}; ///< of the points, instead of those of the energy; none: by energy
};

struct Contact {
    Point at{};    ///< m
    Point force{}; ///< N; none: a disc only
};

/// What a picture shows.
struct Content {
    std::vector<Body> bodies{};
    std::vector<Shell> shells{};
    std::vector<Contact> contacts{};
    std::vector<Point> holds{}; ///< m
    std::vector<SnapMark> snaps{};
    double pixelsPerNewton = 30.0;
};

/// Colour of a stored energy as a share of the full one (0 to 1; NaN: grey), for dark grounds: blue over violet and
/// orange to pale yellow. Lightness rises strictly and equal steps are equal in OKLab, as in decision 0172. The share
/// is that of the amplitude: the square root of the energy's. There are 24 colours.
[[nodiscard]] Colour energyOnDark(double energy, double full);

/// "2.3 mJ": two digits and a prefix.
[[nodiscard]] std::string energyText(double joules);

/// Appends the ground alone.
void addGround(DrawList& list, const View& view);
/// Appends what the world shows, clipped to the picture.
void addWorld(DrawList& list, const View& view, const Content& content);
// Its parts, without a clip.
void addBodies(DrawList& list, const View& view, const std::vector<Body>& bodies);
void addShells(DrawList& list, const View& view, const std::vector<Shell>& shells);
/// A shell alone, without shadow; with an alpha below 1 one that is about to be placed.
void addShell(DrawList& list, const View& view, const Shell& shell, double alpha = 1.0);
void addSnaps(DrawList& list, const View& view, const std::vector<SnapMark>& snaps);

} // namespace supercircle::picture
