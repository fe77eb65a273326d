#include "tests/fuzz/monkey.h"

#include "bridge/box2d/box2d_port.h"
#include "bridge/box2d/debug_draw.h"
#include "plugin/api/include/supercircle/shells.hpp"
#include "supercircle/step/stepper.h"
#include "tests/fuzz/hands.h"
#include "tests/fuzz/surroundings.h"

#include <algorithm>
#include <box2d/box2d.h>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace supercircle::fuzz {

Tally& Tally::operator+=(const Tally& more) {
    calls += more.calls;
    refused += more.refused;
    frames += more.frames;
    replays += more.replays;
    events += more.events;
    if (broken.empty())
        broken = more.broken;
    return *this;
}

namespace {

class Nothing : public b2Draw, public DebugDraw {
public:
    bool tears = false;
    void DrawPolygon(const b2Vec2*, int32, const b2Color&) override {}
    void DrawSolidPolygon(const b2Vec2*, int32, const b2Color&) override {}
    void DrawCircle(const b2Vec2&, float, const b2Color&) override {}
    void DrawSolidCircle(const b2Vec2&, float, const b2Vec2&, const b2Color&) override {}
    void DrawSegment(const b2Vec2&, const b2Vec2&, const b2Color&) override {}
    void DrawTransform(const b2Transform&) override {}
    void DrawPoint(const b2Vec2&, float, const b2Color&) override {}
    void polyline(std::span<const Point>, const Colour&) override {
        if (tears)
            throw std::runtime_error("torn");
    }
    void outline(std::span<const Point>, const Colour&) override {}
    void mark(const Point&, const Colour&) override {}
};

constexpr std::size_t kMostShells = 6;
constexpr int kMostInner = 6; ///< steps after which a frame is stopped, so that a day has room for a million calls
constexpr int kDeepest = 2;   ///< how far calls are nested in callbacks

class Monkey : public b2ContactListener {
public:
    explicit Monkey(const std::vector<std::uint8_t>& bytes) : tape_(bytes), world_({0.0F, -9.81F * 20.0F}) {
        attachment_ = std::make_unique<bridge::Attachment>(bridge::attach(world_, {20.0}));
        shells_ = std::make_unique<Shells>(std::shared_ptr<step::Port>(*attachment_));
        other_ = std::make_unique<Shells>(nullptr);
        world_.SetContactListener(this);
        addBody(world_, tape_, b2_staticBody, {0.0F, -1.0F}, 10.0F, 1.0F);
    }

    Tally run() {
        while (!tape_.over() && tally_.broken.empty())
            act(0);
        if (!tally_.broken.empty())
            tally_.broken += " (call " + std::to_string(tally_.calls) + ", the last ones: " + last_ + ")";
        return tally_;
    }

    void BeginContact(b2Contact*) override {
        if (tape_.chance(60))
            act(1);
    }

private:
    // ---- calls ----

    Shells& some() { return tape_.chance(40) ? *other_ : *shells_; }

    ShellHandle handle() {
        if (!handles_.empty() && tape_.chance(230))
            return handles_[tape_.below(static_cast<std::uint32_t>(handles_.size()))];
        return {tape_.below(10), tape_.below(4), tape_.below(5)};
    }

    ShellDef definition() {
        ShellDef d;
        const int odd = tape_.chance(60) ? 30 : 0;
        d.position = tape_.point(0.25, odd);
        d.angle = tape_.number(-7.0, 7.0, odd);
        d.phi_bar = tape_.number(0.1, 1.0, odd);
        d.radius = tape_.number(0.005, 0.05, odd);
        d.thickness = tape_.number(2e-4, 3e-3, odd);
        d.elements = static_cast<int>(tape_.below(12)) - (odd > 0 ? 2 : -1);
        d.mu = tape_.number(0.0, 1.0, odd);
        d.velocity = tape_.point(1.0, odd);
        d.spin = tape_.number(-40.0, 40.0, odd);
        d.width = tape_.number(0.001, 0.02, odd);
        d.young_modulus = tape_.number(1e8, 3e9, odd);
        d.density = tape_.number(500.0, 2000.0, odd);
        d.closed = tape_.chance(30);
        if (tape_.chance(40))
            d.length = tape_.number(0.01, 0.2, odd);
        if (tape_.chance(40) && d.elements > 0)
            d.curvature.assign(static_cast<std::size_t>(d.elements), tape_.number(-100.0, 100.0, odd));
        if (tape_.chance(40))
            d.tip_refinement = tape_.number(0.3, 3.0, odd);
        d.mask = tape_.chance(30) ? 0 : 0xffff;
        d.name = std::string(1, static_cast<char>('a' + tape_.below(4)));
        return d;
    }

    void remember(const std::string& what) {
        last_ = (last_.size() > 300 ? last_.substr(last_.find(", ", last_.size() - 300) + 2) : last_) + ", " + what +
                tape_.oddOnes();
    }

    /// Counts a call; a refused one must not have changed the state.
    void called(bool done, Shells& shells, std::uint64_t before, const char* what) {
        ++tally_.calls;
        remember(done ? what : std::string(what) + " refused");
        if (done)
            return;
        ++tally_.refused;
        if (shells.hash() != before)
            tally_.broken = std::string("a refused call changed the state: ") + what;
    }

    void create(Shells& s) {
        const std::uint64_t before = s.hash();
        if (s.size() >= kMostShells) {
            const std::vector<ShellHandle> all = s.list();
            const ShellHandle victim = all[tape_.below(static_cast<std::uint32_t>(all.size()))];
            called(static_cast<bool>(s.destroy(victim)), s, before, "destroy");
            return;
        }
        const Result<ShellHandle> made = s.create(definition());
        called(static_cast<bool>(made), s, before, "create");
        if (made)
            handles_.push_back(*made);
        if (handles_.size() > 40)
            handles_.erase(handles_.begin(), handles_.begin() + 20);
        if (!made && made.error().empty())
            tally_.broken = "create gave no reason";
    }

    void frame(Shells& s, int depth) {
        static constexpr double kOdd[] = {0.0,
                                          -1.0,
                                          1e-12,
                                          5e-324,
                                          1e3,
                                          1e300,
                                          std::numeric_limits<double>::quiet_NaN(),
                                          std::numeric_limits<double>::infinity()};
        const std::uint64_t before = s.hash();
        const double dt = tape_.chance(20) ? kOdd[tape_.below(8)] : tape_.number(1e-4, 2e-2, 0);
        int inner = 0;
        const FrameReport r = s.pre_step(dt, [&] {
            if (depth < kDeepest && tape_.chance(50))
                act(depth + 1);
            if (tape_.chance(2))
                throw std::runtime_error("the observer gives up");
            return ++inner >= kMostInner || tape_.chance(5);
        });
        ++tally_.calls;
        remember((&s == shells_.get() ? "frame " : "other frame ") + std::to_string(dt) + " " + r.failure);
        if (r.failure.empty())
            ++tally_.frames;
        else
            ++tally_.refused;
        if (inner == 0 && !(dt > 0.0 && dt < 1.0) && s.hash() != before)
            tally_.broken = "a refused frame changed the state: dt = " + std::to_string(dt) + " s, " + r.failure;
        if (depth == 0)
            look(s);
        if (&s == shells_.get() && tape_.chance(230) && !world_.IsLocked())
            world_.Step(static_cast<float>(tape_.chance(10) ? 0.0 : r.advanced), 8, 3);
        if (tape_.chance(230))
            s.post_step();
    }

    /// After a frame: everything that can be asked is finite, events name shells that are or were.
    void look(Shells& s) {
        const FrameEvents& e = s.events();
        tally_.events += e.contact_begin.size() + e.contact_end.size() + e.impulses.size() + e.snap_begin.size() +
                         e.snap_end.size() + e.quarantined.size();
        for (const ContactBeginEvent& b : e.contact_begin)
            if (b.at.a.null() || !std::isfinite(b.approach_speed) ||
                !(b.at.fraction_a >= 0.0 && b.at.fraction_a <= 1.0))
                tally_.broken = "a contact event makes no sense";
        const std::vector<ShellHandle> all = s.list();
        if (all.size() != s.size())
            tally_.broken = "the list has another size than the world";
        for (const ShellHandle& h : all) {
            const Result<ShellMeasures> m = s.measure(h);
            if (!m || !std::isfinite(m->centre.x) || !std::isfinite(m->box.upper.y) || !std::isfinite(m->stored_energy))
                tally_.broken = "a shell has bad numbers: " + (m ? "centre " + std::to_string(m->centre.x) +
                                                                       ", box up to " + std::to_string(m->box.upper.y) +
                                                                       ", stored " + std::to_string(m->stored_energy) +
                                                                       " J" + (m->quarantined ? ", quarantined" : "")
                                                                 : m.error());
        }
        if (!std::isfinite(s.time()) || !std::isfinite(s.books().kinetic))
            tally_.broken = "the books have bad numbers: kinetic " + std::to_string(s.books().kinetic) + " J";
    }

    void ask(Shells& s) {
        const std::uint64_t before = s.hash();
        const Point a = tape_.point(0.3, 10), b = tape_.point(0.3, 10);
        const ShellHandle h = handle();
        bool done = true;
        switch (tape_.below(12)) {
        case 0:
            done = static_cast<bool>(s.ray_cast(a, b));
            break;
        case 1:
            done = static_cast<bool>(s.ray_cast_all(a, b));
            break;
        case 2:
            done = static_cast<bool>(s.overlap_point(a));
            break;
        case 3:
            done = static_cast<bool>(s.overlap_box({a, b}));
            break;
        case 4:
            done = static_cast<bool>(s.overlap_circle(a, tape_.number(0.0, 0.1, 20)));
            break;
        case 5:
            done = static_cast<bool>(s.nearest(a, tape_.number(0.0, 0.1, 20)));
            break;
        case 6:
            done = static_cast<bool>(s.nearest(h, a));
            break;
        case 7:
            done = static_cast<bool>(s.section(h, tape_.number(0.0, 1.0, 20)));
            break;
        case 8:
            done = static_cast<bool>(s.measure(h));
            break;
        case 9:
            done = static_cast<bool>(s.pose(h));
            break;
        case 10:
            done = static_cast<bool>(s.name(h)) && static_cast<bool>(s.user_data(h));
            break;
        default:
            done = !s.find(std::string(1, static_cast<char>('a' + tape_.below(5)))).null();
            break;
        }
        called(done, s, before, "question");
        if (s.hash() != before)
            tally_.broken = "a question changed the state";
    }

    void saveOrRestore(Shells& s) {
        const std::uint64_t before = s.hash();
        if (saved_.size() < 3 || tape_.chance(60)) {
            if (saved_.size() > 4)
                saved_.erase(saved_.begin());
            saved_.push_back(s.save());
            ++tally_.calls;
            return;
        }
        Snapshot state = saved_[tape_.below(static_cast<std::uint32_t>(saved_.size()))];
        if (tape_.chance(60)) {
            std::vector<std::uint8_t> bytes = state.bytes();
            if (tape_.chance(100))
                bytes[tape_.below(static_cast<std::uint32_t>(bytes.size()))] ^= 4;
            const Result<Snapshot> read = Snapshot::from_bytes(std::move(bytes));
            ++tally_.calls;
            if (!read)
                return;
            state = *read;
        }
        const Outcome done = s.restore(state);
        called(static_cast<bool>(done), s, before, "restore");
        for (const ShellHandle& h : s.list())
            handles_.push_back(h);
    }

    void logOrReplay(Shells& s) {
        if (s.log().calls() == 0 || s.log().calls() > 60) {
            s.start_log(tape_.byte());
            ++tally_.calls;
            if (&s == other_.get())
                faithful_ = true;
            return;
        }
        const CallLog log = s.log();
        Shells again(nullptr);
        tally_.calls += 2;
        if (&s != other_.get()) { // its bodies are missing there
            (void)again.replay(log, [&](double) { return !tape_.chance(20); });
        } else {
            const Outcome replayed = again.replay(log);
            if (faithful_ && (!replayed || again.hash() != s.hash()))
                tally_.broken = "a log replays to another state: " + replayed.error();
            tally_.replays += faithful_ ? 1 : 0;
        }
        if (tape_.chance(128)) {
            s.stop_log();
            faithful_ = false;
        }
    }

    void act(int depth) {
        Shells& s = some();
        const std::uint64_t before = s.hash();
        switch (tape_.below(34)) {
        case 0:
        case 1:
        case 2:
            create(s);
            break;
        case 3:
            called(static_cast<bool>(s.destroy(handle())), s, before, "destroy");
            break;
        case 4: {
            const bool machine = tape_.chance(60);
            const double place = tape_.number(0.0, 1.0, 20);
            const HoldKind kind = tape_.chance(128) ? HoldKind::Pin : HoldKind::Clamp;
            called(static_cast<bool>(s.hold(handle(), place, kind, machine)), s, before, "hold");
            break;
        }
        case 5:
            called(static_cast<bool>(s.carry(tape_.chance(200) ? "plate" : "nobody")), s, before, "carry");
            break;
        case 6:
            called(static_cast<bool>(s.set_machine_velocity(tape_.point(0.5, 10))), s, before, "set_machine_velocity");
            break;
        case 7:
        case 8:
        case 9:
        case 10:
            frame(s, depth);
            break;
        case 11:
        case 12:
        case 13:
            ask(s);
            break;
        case 14:
            saveOrRestore(s);
            break;
        case 15: {
            Nothing paper;
            paper.tears = tape_.chance(60);
            bridge::DrawAdapter adapter(paper, tape_.number(1.0, 60.0, 20));
            DrawOptions options;
            options.tolerance = tape_.number(1e-6, 1e-3, 20);
            options.metres_per_newton = tape_.number(0.0, 1.0, 20);
            DebugDraw& canvas = tape_.chance(128) ? static_cast<DebugDraw&>(paper) : adapter;
            called(static_cast<bool>(s.draw(canvas, options)), s, before, "draw");
            break;
        }
        case 16:
            called(static_cast<bool>(s.set_name(handle(), "b")), s, before, "set_name");
            break;
        case 17:
            called(static_cast<bool>(s.set_user_data(handle(), 7)), s, before, "set_user_data");
            break;
        case 18: {
            EventSettings e;
            e.impulse_threshold = tape_.number(0.0, 1e-3, 30);
            e.snap_energy = tape_.number(1e-3, 0.1, 30);
            e.snap_time = tape_.number(1e-3, 0.3, 30);
            called(static_cast<bool>(s.set_event_settings(e)), s, before, "set_event_settings");
            break;
        }
        case 19:
            if (depth == 0)
                logOrReplay(s);
            break;
        case 20:
            s.post_step();
            ++tally_.calls;
            break;
        case 21:
            if (depth == 0 && tape_.chance(40)) { // as a bug in somebody's effect would
                step::World& w = s.world();
                if (&s == other_.get())
                    faithful_ = false; // no log knows of it
                remember("bad number put in");
                if (!w.rods.empty())
                    w.rods[tape_.below(static_cast<std::uint32_t>(w.rods.size()))].v[0] =
                        std::numeric_limits<double>::quiet_NaN();
            } else if (depth == 0 && tape_.chance(40)) { // objects move
                auto moved = std::make_unique<Shells>(std::move(*other_));
                other_ = std::move(moved);
            }
            break;
        case 22:
        case 23:
            disturb(world_, *attachment_, tape_);
            break;
        default: {
            BodyId body = s.body("plate") ? *s.body("plate") : 0;
            if (b2Body* b = tape_.chance(128) ? someBody(world_, tape_) : nullptr)
                body = attachment_->body_id(*b);
            const Hands::Made made = hands_.act(s, tape_, {handle(), handle(), tape_.chance(250) ? body : 77});
            called(made.done, s, before, made.what);
            break;
        }
        }
    }

    Tape tape_;
    Hands hands_;
    b2World world_;
    std::unique_ptr<bridge::Attachment> attachment_;
    std::unique_ptr<Shells> shells_, other_;
    std::vector<ShellHandle> handles_;
    std::vector<Snapshot> saved_;
    bool faithful_ = false; ///< the log of the other shells tells everything since it began
    Tally tally_;
    std::string last_; ///< calls before the end, for messages
};

} // namespace

Tally play(const std::vector<std::uint8_t>& tape) {
    return Monkey(tape).run();
}

} // namespace supercircle::fuzz
