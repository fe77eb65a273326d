// Mouse joints: springs that pull a shell or a body to a target.

#include "bridge/c/world.h"

using namespace supercircle::c;
using supercircle::MouseJointDef;

namespace {

constexpr double kFrequency = 5.0, kDamping = 0.7; ///< Hz and 1, of grabbed bodies: as of shells
constexpr double kAcceleration = 1000.0;           ///< m/s^2, of the default largest force

/// Box2D destroys a joint with its bodies without a word: it is looked up each time.
b2MouseJoint* jointOf(World& w, std::uint64_t mark) {
    for (b2Joint* j = w.box2d->GetJointList(); j != nullptr; j = j->GetNext())
        if (j->GetType() == e_mouseJoint && j->GetUserData().pointer == static_cast<uintptr_t>(mark))
            return static_cast<b2MouseJoint*>(j);
    return nullptr;
}

bool lives(World& w, const Spring& s) {
    return s.onBody != 0 ? jointOf(w, s.onBody) != nullptr : w.shells.valid(s.onShell);
}

Spring& springOf(World& w, sc_mouse_joint m) {
    Spring* s = w.springs.find(m.id);
    if (s == nullptr || !lives(w, *s))
        refuse(SC_STALE, std::string("the mouse joint handle is ") +
                             (m.id == 0 ? "null" : "stale: it was destroyed, or belongs to another world"));
    return *s;
}

sc_mouse_joint add(World& w, const Spring& spring) {
    w.springs.sweep([&](std::uint64_t, const Spring& s) { return !lives(w, s); });
    const std::uint64_t id = w.springs.add(spring);
    if (id == 0)
        refuse(SC_REFUSED, "there are a million mouse joints already");
    return {id};
}

class DynamicBodyAt : public b2QueryCallback {
public:
    explicit DynamicBodyAt(const b2Vec2& p) : point_(p) {}
    bool ReportFixture(b2Fixture* f) override {
        if (f->GetBody()->GetType() == b2_dynamicBody && f->TestPoint(point_))
            body = f->GetBody();
        return body == nullptr;
    }
    b2Body* body = nullptr;

private:
    b2Vec2 point_;
};

/// The other end of a b2MouseJoint; any body that stays.
b2Body* ground(b2World& world) {
    for (b2Body* b = world.GetBodyList(); b != nullptr; b = b->GetNext())
        if (b->GetType() == b2_staticBody)
            return b;
    const b2BodyDef d;
    return world.CreateBody(&d);
}

b2Vec2 hostPoint(const World& w, sc_point p) {
    if (!(std::abs(p.x * w.scale) < 1e6 && std::abs(p.y * w.scale) < 1e6))
        refuse(SC_BAD_INPUT, "the point is not finite or above a million Box2D units");
    return {static_cast<float>(p.x * w.scale), static_cast<float>(p.y * w.scale)};
}

} // namespace

void sc_mouse_joint_def_init(sc_mouse_joint_def* def) {
    if (def == nullptr)
        return;
    const MouseJointDef d;
    *def = {sizeof *def, 0, d.arc_fraction, {0.0, 0.0}, d.frequency, d.damping_ratio, d.max_force};
}

sc_status sc_mouse_joint_create(sc_world w, sc_shell s, const sc_mouse_joint_def* def, sc_mouse_joint* out) {
    return use(w, [&](World& x) {
        given(out, "the result");
        const sc_mouse_joint_def d =
            versioned(def, sc_mouse_joint_def_init, sizeof(sc_mouse_joint_def), "sc_mouse_joint_def_init");
        const MouseJointDef m{d.arc_fraction, in(d.target), d.frequency, d.damping_ratio, d.max_force};
        *out = add(x, {done(x.shells.create_mouse_joint(x.in(s), m)), 0});
    });
}

sc_status sc_body_grab(sc_world w, sc_point at, double max_force, sc_mouse_joint* out) {
    return use(w, [&](World& x) {
        given(out, "the result");
        x.requireUnlocked();
        const b2Vec2 point = hostPoint(x, at);
        if (!(max_force >= 0.0 && max_force < 1e20))
            refuse(SC_BAD_INPUT, "the largest force must be a finite number of newtons, 0 or more");
        DynamicBodyAt found(point);
        const b2Vec2 little(1e-3F, 1e-3F);
        x.box2d->QueryAABB(&found, {point - little, point + little});
        if (found.body == nullptr)
            refuse(SC_REFUSED, "there is no dynamic body at this point");
        const double force = max_force > 0.0 ? max_force : kAcceleration * static_cast<double>(found.body->GetMass());
        const std::uint64_t mark = std::uint64_t{0x5c5c} << 48 | nextGeneration();
        b2MouseJointDef d;
        d.bodyA = ground(*x.box2d);
        d.bodyB = found.body;
        d.target = point;
        d.maxForce = static_cast<float>(force * x.scale);
        d.userData.pointer = static_cast<uintptr_t>(mark);
        b2LinearStiffness(d.stiffness, d.damping, static_cast<float>(kFrequency), static_cast<float>(kDamping), d.bodyA,
                          d.bodyB);
        x.box2d->CreateJoint(&d);
        found.body->SetAwake(true);
        *out = add(x, {{}, mark});
    });
}

int32_t sc_mouse_joint_valid(sc_world w, sc_mouse_joint m) {
    return validIn(w, [&](World& x) {
        const Spring* s = x.springs.find(m.id);
        return s != nullptr && lives(x, *s);
    });
}

sc_status sc_mouse_joint_move(sc_world w, sc_mouse_joint m, sc_point target) {
    return use(w, [&](World& x) {
        const Spring& s = springOf(x, m);
        if (s.onBody == 0) {
            done(x.shells.set_target(s.onShell, in(target)));
            return;
        }
        x.requireUnlocked();
        jointOf(x, s.onBody)->SetTarget(hostPoint(x, target));
    });
}

sc_status sc_mouse_joint_reaction(sc_world w, sc_mouse_joint m, sc_reaction* result) {
    return use(w, [&](World& x) {
        given(result, "the result");
        const Spring& s = springOf(x, m);
        if (s.onBody == 0) {
            *result = out(done(x.shells.reaction(s.onShell)));
            return;
        }
        const float inverse = x.lastStep > 0.0 ? static_cast<float>(1.0 / x.lastStep) : 0.0F;
        const b2Vec2 f = jointOf(x, s.onBody)->GetReactionForce(inverse);
        *result = {{static_cast<double>(f.x) / x.scale, static_cast<double>(f.y) / x.scale}, 0.0};
    });
}

sc_status sc_mouse_joint_destroy(sc_world w, sc_mouse_joint m) {
    return use(w, [&](World& x) {
        const Spring s = springOf(x, m);
        if (s.onBody == 0) {
            done(x.shells.destroy(s.onShell), SC_REFUSED);
        } else {
            x.requireUnlocked();
            x.box2d->DestroyJoint(jointOf(x, s.onBody));
        }
        x.springs.remove(m.id);
    });
}
