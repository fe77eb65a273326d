#pragma once
// Proxies of shells in a b2World, for ray casts, queries, sensor contacts and contact listeners.

#include <supercircle/draw.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

class b2Body;
class b2Fixture;
class b2World;

namespace supercircle::bridge {

/// Kinematic bodies with sensor edges along the surfaces of the shells. Optional; they exert no force, and the coupling
/// ignores them. Each frame, after post_step():
///
///     proxies.begin();  shells.draw(proxies, proxies.options());  proxies.end();
///
/// b2World::RayCast, b2World::QueryAABB and dynamic bodies (their fixtures' sensor contacts: BeginContact, EndContact)
/// find them where the shells were at the last end(). Sensors on static or kinematic bodies do not, because a contact
/// of Box2D 2.4 needs a dynamic body. The world must outlive this object, unless release() is called before.
class ShellProxies : public DebugDraw {
public:
    static constexpr std::size_t kNone = static_cast<std::size_t>(-1);

    /// `units_per_metre` as given to attach(). A value that is not finite and positive counts as 1.
    explicit ShellProxies(b2World& world, double units_per_metre = 1.0);
    ~ShellProxies() override;
    ShellProxies(const ShellProxies&) = delete;
    ShellProxies& operator=(const ShellProxies&) = delete;

    /// Options for Shells::draw: outlines only.
    [[nodiscard]] static DrawOptions options();
    /// Starts a frame: discards the outlines of the last one.
    void begin();
    /// Updates the proxies. Returns false and changes nothing inside the world's callbacks.
    bool end();
    /// Index of the outline that a fixture represents, or kNone. Outlines are in the order of Shells::shells(), one per
    /// shell and two (outer and inner) per ring.
    [[nodiscard]] std::size_t outline_of(const b2Fixture& fixture) const;
    /// Removes the bodies from the world (not inside its callbacks). The next end() creates them again.
    void release();
    /// Filter of proxy fixtures created later, as in b2Filter.
    std::uint16_t category = 0x0001;
    std::uint16_t mask = 0xFFFF;

    void polyline(std::span<const Point> points, const Colour& colour) override;
    void outline(std::span<const Point> points, const Colour& colour) override;
    void mark(const Point& at, const Colour& colour) override;

private:
    b2World* world_;
    double scale_;
    std::vector<b2Body*> bodies_; ///< one per outline
    std::vector<std::vector<Point>> outlines_;
};

} // namespace supercircle::bridge
