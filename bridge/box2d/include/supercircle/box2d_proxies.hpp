#pragma once
// Shells for the eyes of Box2D: rays, queries, sensors' contacts and the contact listener of a b2World see them.

#include <supercircle/draw.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

class b2Body;
class b2Fixture;
class b2World;

namespace supercircle::bridge {

/// Kinematic bodies with sensor edges along the surfaces of the shells. Optional; they push nobody, and the coupling
/// does not see them. Each frame, after post_step():
///
///     proxies.begin();  shells.draw(proxies, proxies.options());  proxies.end();
///
/// b2World::RayCast, b2World::QueryAABB and dynamic bodies (their fixtures' sensor contacts: BeginContact, EndContact)
/// meet them where the shells were at the last end(). Sensors on static or kinematic bodies do not: Box2D 2.4 wants
/// one dynamic body in a contact. The world must outlive this object, or release() be called before it goes.
class ShellProxies : public DebugDraw {
public:
    static constexpr std::size_t kNone = static_cast<std::size_t>(-1);

    /// `units_per_metre` as given to attach(). A value that is not finite and positive counts as 1.
    explicit ShellProxies(b2World& world, double units_per_metre = 1.0);
    ~ShellProxies() override;
    ShellProxies(const ShellProxies&) = delete;
    ShellProxies& operator=(const ShellProxies&) = delete;

    /// What Shells::draw should say: outlines, nothing else.
    [[nodiscard]] static DrawOptions options();
    void begin();
    /// False, and nothing moved, inside the world's own callbacks.
    bool end();
    /// The how manyeth outline a fixture stands for, kNone: for none. Shells::draw gives them in the order of
    /// Shells::list(), one per shell and two (outer and inner) per ring.
    [[nodiscard]] std::size_t outline_of(const b2Fixture& fixture) const;
    /// Takes the bodies out of the world (not inside its callbacks). The next end() makes them anew.
    void release();
    /// Of all proxy fixtures, as in b2Filter; for those made later.
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
