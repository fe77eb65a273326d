#pragma once
// Draws shells with a b2Draw: one debug renderer shows Box2D's bodies and the shells.

#include <supercircle/draw.hpp>

#include <vector>

class b2Draw;

namespace supercircle::bridge {

/// Passes the output of Shells::draw() to a b2Draw, in Box2D units. Lines become segments, marks become points. The
/// b2Draw must outlive this object; its flags are not evaluated.
class DrawAdapter : public DebugDraw {
public:
    /// `units_per_metre` as given to attach(). A value that is not finite and positive counts as 1.
    explicit DrawAdapter(b2Draw& target, double units_per_metre = 1.0);
    void polyline(std::span<const Point> points, const Colour& colour) override;
    void outline(std::span<const Point> points, const Colour& colour) override;
    void mark(const Point& at, const Colour& colour) override;
    float mark_size = 5.0F; ///< pixels

private:
    b2Draw* target_;
    double scale_;
};

} // namespace supercircle::bridge
