#include "bridge/box2d/lab_world.h"

#include "bridge/box2d/box2d_port.h"
#include "bridge/box2d/rigid_check.h"

#include <box2d/box2d.h>
#include <cmath>
#include <stdexcept>

namespace supercircle::bridge {

namespace {

using step::BodyId;
using step::BodyOutline;
using step::BodyState;
using step::RigidWorldDefinition;
using step::Vec2;

constexpr int kVelocityIterations = 8;
constexpr int kPositionIterations = 3;

class LabWorld final : public step::HostWorld {
public:
    explicit LabWorld(const RigidWorldDefinition& d)
        : world_(
              {static_cast<float>(d.gravity.x() * d.lengthScale), static_cast<float>(d.gravity.y() * d.lengthScale)}),
          port_(world_, Options{d.lengthScale}) {}

    [[nodiscard]] Vec2 gravity() const override { return port_.gravity(); }
    [[nodiscard]] double unitsPerMetre() const override { return port_.unitsPerMetre(); }
    void query(const step::Box& box, std::vector<BodyOutline>& out) const override { port_.query(box, out); }
    void queryAhead(std::span<const step::Box> boxes, double ahead, std::vector<BodyOutline>& out) const override {
        port_.queryAhead(boxes, ahead, out);
    }
    [[nodiscard]] bool state(BodyId body, BodyState& out) const override { return port_.state(body, out); }
    void constraints(const std::vector<BodyId>& seeds, double dt, step::HostConstraints& out) const override {
        port_.constraints(seeds, dt, out);
    }
    void impulses(double dt, step::HostConstraints& io) const override { port_.impulses(dt, io); }
    void applyImpulse(BodyId body, const Vec2& impulse, double angularImpulse) override {
        port_.applyImpulse(body, impulse, angularImpulse);
    }
    void setVelocity(BodyId body, const Vec2& velocity, double spin) override {
        port_.setVelocity(body, velocity, spin);
    }
    void setAwake(BodyId body, bool awake) override { port_.setAwake(body, awake); }
    void place(BodyId body, const Vec2& centre, double angle) override { port_.place(body, centre, angle); }
    void putBack(BodyId body, const Vec2& centre, double angle) override { port_.putBack(body, centre, angle); }
    void foresee(double ahead) override { port_.foresee(ahead); }
    void strayed(std::span<const BodyId> known, std::span<const step::Box> boxes, std::vector<step::StrayBody>& strays,
                 std::vector<BodyOutline>& out) const override {
        port_.strayed(known, boxes, strays, out);
    }
    void drive(BodyId body, const Vec2& centre, double angle, const Vec2& velocity, double spin) override {
        port_.drive(body, centre, angle, velocity, spin);
    }
    [[nodiscard]] BodyId find(const std::string& name) const override { return port_.find(name); }
    std::string build(const RigidWorldDefinition& d) override { return port_.build(d); }
    std::string shiftOrigin(const Vec2& by) override { return port_.shiftOrigin(by); }
    [[nodiscard]] std::string takeNote() const override { return port_.takeNote(); }
    void everything(std::vector<BodyOutline>& out) const override { port_.everything(out); }
    void put(BodyId body, const BodyState& state) override { port_.put(body, state); }

    void step(double dt) override {
        if (!std::isfinite(dt) || dt <= 0.0)
            throw std::invalid_argument("the time step of the host world must be finite and positive");
        world_.Step(static_cast<float>(dt), kVelocityIterations, kPositionIterations);
        port_.stepped(dt);
    }

private:
    b2World world_;
    Box2dPort port_;
};

} // namespace

std::unique_ptr<step::HostWorld> makeWorld(const RigidWorldDefinition& definition, std::string& error) {
    error = checkDefinition(definition); // before the world exists: an invalid length scale must not reach it
    if (!error.empty())
        return nullptr;
    auto lab = std::make_unique<LabWorld>(definition);
    error = lab->build(definition);
    return error.empty() ? std::move(lab) : nullptr;
}

} // namespace supercircle::bridge
