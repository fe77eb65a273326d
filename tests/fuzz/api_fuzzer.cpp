#include "tests/fuzz/api_fuzzer.h"

#include "bridge/box2d/box2d_port.h"
#include "bridge/box2d/debug_draw.h"
#include "plugin/api/include/supercircle/shells.hpp"
#include "supercircle/step/stepper.h"
#include "tests/fuzz/host_actions.h"
#include "tests/fuzz/shell_actions.h"

#include <algorithm>
#include <box2d/box2d.h>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace supercircle::fuzz {

Statistics& Statistics::operator+=(const Statistics& more) {
    calls += more.calls;
    failed += more.failed;
    frames += more.frames;
    replays += more.replays;
    events += more.events;
    alarms += more.alarms;
    if (violation.empty())
        violation = more.violation;
    return *this;
}

namespace {

class NullCanvas : public b2Draw, public DebugDraw {
public:
    bool throws = false;
    void DrawPolygon(const b2Vec2*, int32, const b2Color&) override {}
    void DrawSolidPolygon(const b2Vec2*, int32, const b2Color&) override {}
    void DrawCircle(const b2Vec2&, float, const b2Color&) override {}
    void DrawSolidCircle(const b2Vec2&, float, const b2Vec2&, const b2Color&) override {}
    void DrawSegment(const b2Vec2&, const b2Vec2&, const b2Color&) override {}
    void DrawTransform(const b2Transform&) override {}
    void DrawPoint(const b2Vec2&, float, const b2Color&) override {}
    void polyline(std::span<const Point>, const Colour&) override {
        if (throws)
            throw std::runtime_error("torn");
    }
    void outline(std::span<const Point>, const Colour&) override {}
    void mark(const Point&, const Colour&) override {}
};

constexpr std::size_t kMostShells = 6;
constexpr int kMostInner = 6; ///< steps after which a frame is stopped, to bound the duration
constexpr int kDeepest = 2;   ///< depth of calls nested in callbacks

class ApiFuzzer : public b2ContactListener {
public:
    explicit ApiFuzzer(const std::vector<std::uint8_t>& bytes) : bytes_(bytes), world_({0.0F, -9.81F * 20.0F}) {
        attachment_ = std::make_unique<bridge::Attachment>(bridge::attach(world_, {20.0}));
        shells_ = std::make_unique<Shells>(std::shared_ptr<step::Port>(*attachment_));
        other_ = std::make_unique<Shells>(nullptr);
        world_.SetContactListener(this);
        addBody(world_, bytes_, b2_staticBody, {0.0F, -1.0F}, 10.0F, 1.0F);
    }

    Statistics run() {
        while (!bytes_.empty() && statistics_.violation.empty())
            act(0);
        if (!statistics_.violation.empty())
            statistics_.violation +=
                " (call " + std::to_string(statistics_.calls) + ", the last ones: " + history_ + ")";
        return statistics_;
    }

    void BeginContact(b2Contact*) override {
        if (bytes_.chance(60))
            act(1);
    }

private:
    // ---- calls ----

    Shells& pickShells() { return bytes_.chance(40) ? *other_ : *shells_; }

    ShellHandle handle() {
        if (!handles_.empty() && bytes_.chance(230))
            return handles_[bytes_.below(static_cast<std::uint32_t>(handles_.size()))];
        return {bytes_.below(10), bytes_.below(4), bytes_.below(5)};
    }

    ShellDef definition() {
        ShellDef d;
        const int odd = bytes_.chance(60) ? 30 : 0;
        d.position = bytes_.point(0.25, odd);
        d.angle = bytes_.number(-7.0, 7.0, odd);
        d.phi_bar = bytes_.number(0.1, 1.0, odd);
        d.radius = bytes_.number(0.005, 0.05, odd);
        d.thickness = bytes_.number(2e-4, 3e-3, odd);
        d.elements = static_cast<int>(bytes_.below(12)) - (odd > 0 ? 2 : -1);
        d.mu = bytes_.number(0.0, 1.0, odd);
        d.velocity = bytes_.point(1.0, odd);
        d.spin = bytes_.number(-40.0, 40.0, odd);
        d.width = bytes_.number(0.001, 0.02, odd);
        d.young_modulus = bytes_.number(1e8, 3e9, odd);
        d.density = bytes_.number(500.0, 2000.0, odd);
        d.closed = bytes_.chance(30);
        if (bytes_.chance(40))
            d.length = bytes_.number(0.01, 0.2, odd);
        if (bytes_.chance(40) && d.elements > 0)
            d.curvature.assign(static_cast<std::size_t>(d.elements), bytes_.number(-100.0, 100.0, odd));
        if (bytes_.chance(40))
            d.tip_refinement = bytes_.number(0.3, 3.0, odd);
        d.mask = bytes_.chance(30) ? 0 : 0xffff;
        d.name = std::string(1, static_cast<char>('a' + bytes_.below(4)));
        return d;
    }

    void addToHistory(const std::string& what) {
        history_ =
            (history_.size() > 300 ? history_.substr(history_.find(", ", history_.size() - 300) + 2) : history_) +
            ", " + what + bytes_.takeOddNumbers();
    }

    /// Counts a call; a failed one must not change the state.
    void called(bool done, Shells& shells, std::uint64_t before, const char* what) {
        ++statistics_.calls;
        addToHistory(done ? what : std::string(what) + " failed");
        if (done)
            return;
        ++statistics_.failed;
        if (shells.hash() != before)
            statistics_.violation = std::string("a failed call changed the state: ") + what;
    }

    void create(Shells& s) {
        const std::uint64_t before = s.hash();
        if (s.size() >= kMostShells) {
            const std::vector<ShellHandle> all = s.shells();
            const ShellHandle victim = all[bytes_.below(static_cast<std::uint32_t>(all.size()))];
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
            statistics_.violation = "create gave no reason";
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
        const double dt = bytes_.chance(20) ? kOdd[bytes_.below(8)] : bytes_.number(1e-4, 2e-2, 0);
        int inner = 0;
        const FrameReport r = s.pre_step(dt, [&] {
            if (depth < kDeepest && bytes_.chance(50))
                act(depth + 1);
            if (bytes_.chance(2))
                throw std::runtime_error("the observer gives up");
            return ++inner >= kMostInner || bytes_.chance(5);
        });
        ++statistics_.calls;
        addToHistory((&s == shells_.get() ? "frame " : "other frame ") + std::to_string(dt) + " " + r.failure);
        if (r.failure.empty())
            ++statistics_.frames;
        else
            ++statistics_.failed;
        if (inner == 0 && !(dt > 0.0 && dt < 1.0) && s.hash() != before)
            statistics_.violation = "a failed frame changed the state: dt = " + std::to_string(dt) + " s, " + r.failure;
        statistics_.alarms += r.energy_gained > 0.0 && r.unconverged == 0; // what has no solution keeps no energy
        if (depth == 0)
            checkState(s);
        if (&s == shells_.get() && bytes_.chance(230) && !world_.IsLocked())
            world_.Step(static_cast<float>(bytes_.chance(10) ? 0.0 : r.advanced), 8, 3);
        if (bytes_.chance(230))
            (void)s.post_step();
    }

    /// After a frame: all queries are finite, and events have shells.
    void checkState(Shells& s) {
        const FrameEvents& e = s.events();
        statistics_.events += e.contact_begin.size() + e.contact_end.size() + e.impulses.size() + e.snap_begin.size() +
                              e.snap_end.size() + e.quarantined.size() + e.overlapping.size();
        for (const ContactBeginEvent& b : e.contact_begin)
            if (b.at.a.null() || !std::isfinite(b.approach_speed) ||
                !(b.at.fraction_a >= 0.0 && b.at.fraction_a <= 1.0))
                statistics_.violation = "a contact event makes no sense";
        const std::vector<ShellHandle> all = s.shells();
        if (all.size() != s.size())
            statistics_.violation = "shells() and size() differ";
        for (const ShellHandle& h : all) {
            const Result<ShellState> m = s.state(h);
            if (!m || !std::isfinite(m->centre.x) || !std::isfinite(m->box.upper.y) || !std::isfinite(m->stored_energy))
                statistics_.violation =
                    "a shell has bad numbers: " +
                    (m ? "centre " + std::to_string(m->centre.x) + ", box up to " + std::to_string(m->box.upper.y) +
                             ", stored " + std::to_string(m->stored_energy) + " J" +
                             (m->quarantined ? ", quarantined" : "")
                       : m.error());
        }
        if (!std::isfinite(s.time()) || !std::isfinite(s.energy_balance().kinetic))
            statistics_.violation =
                "the energy balance has bad numbers: kinetic " + std::to_string(s.energy_balance().kinetic) + " J";
    }

    void query(Shells& s) {
        const std::uint64_t before = s.hash();
        const Point a = bytes_.point(0.3, 10), b = bytes_.point(0.3, 10);
        const ShellHandle h = handle();
        bool done = true;
        switch (bytes_.below(12)) {
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
            done = static_cast<bool>(s.overlap_circle(a, bytes_.number(0.0, 0.1, 20)));
            break;
        case 5:
            done = static_cast<bool>(s.closest_point(a, bytes_.number(0.0, 0.1, 20)));
            break;
        case 6:
            done = static_cast<bool>(s.closest_point(h, a));
            break;
        case 7:
            done = static_cast<bool>(s.section(h, bytes_.number(0.0, 1.0, 20)));
            break;
        case 8:
            done = static_cast<bool>(s.state(h));
            break;
        case 9:
            done = static_cast<bool>(s.pose(h));
            break;
        case 10:
            done = static_cast<bool>(s.name(h)) && static_cast<bool>(s.user_data(h));
            break;
        default:
            done = !s.find(std::string(1, static_cast<char>('a' + bytes_.below(5)))).null();
            break;
        }
        called(done, s, before, "question");
        if (s.hash() != before)
            statistics_.violation = "a question changed the state";
    }

    void saveOrRestore(Shells& s) {
        const std::uint64_t before = s.hash();
        if (saved_.size() < 3 || bytes_.chance(60)) {
            if (saved_.size() > 4)
                saved_.erase(saved_.begin());
            saved_.push_back(s.save());
            ++statistics_.calls;
            return;
        }
        Snapshot state = saved_[bytes_.below(static_cast<std::uint32_t>(saved_.size()))];
        if (bytes_.chance(60)) {
            std::vector<std::uint8_t> bytes = state.bytes();
            if (bytes_.chance(100))
                bytes[bytes_.below(static_cast<std::uint32_t>(bytes.size()))] ^= 4;
            const Result<Snapshot> read = Snapshot::from_bytes(std::move(bytes));
            ++statistics_.calls;
            if (!read)
                return;
            state = *read;
        }
        const Status done = s.restore(state);
        called(static_cast<bool>(done), s, before, "restore");
        for (const ShellHandle& h : s.shells())
            handles_.push_back(h);
    }

    void logOrReplay(Shells& s) {
        if (s.log().calls() == 0 || s.log().calls() > 60) {
            (void)s.start_log(bytes_.byte());
            ++statistics_.calls;
            if (&s == other_.get())
                logComplete_ = true;
            return;
        }
        const CallLog log = s.log();
        Shells again(nullptr);
        statistics_.calls += 2;
        if (&s != other_.get()) { // its bodies are missing in the replay
            (void)again.replay(log, [&](double) { return !bytes_.chance(20); });
        } else {
            const Status replayed = again.replay(log);
            if (logComplete_ && (!replayed || again.hash() != s.hash()))
                statistics_.violation = "a log replays to another state: " + replayed.error();
            statistics_.replays += logComplete_ ? 1 : 0;
        }
        if (bytes_.chance(128)) {
            s.stop_log();
            logComplete_ = false;
        }
    }

    void act(int depth) {
        Shells& s = pickShells();
        const std::uint64_t before = s.hash();
        switch (bytes_.below(34)) {
        case 0:
        case 1:
        case 2:
            create(s);
            break;
        case 3:
            called(static_cast<bool>(s.destroy(handle())), s, before, "destroy");
            break;
        case 4: {
            const HoldBase base = bytes_.chance(60) ? HoldBase::Moving : HoldBase::Fixed;
            const double place = bytes_.number(0.0, 1.0, 20);
            const HoldKind kind = bytes_.chance(128) ? HoldKind::Pin : HoldKind::Clamp;
            called(static_cast<bool>(s.create_hold(handle(), place, kind, base)), s, before, "create_hold");
            break;
        }
        case 5:
            called(static_cast<bool>(s.attach_to_crosshead(bytes_.chance(200) ? "plate" : "nobody")), s, before,
                   "attach_to_crosshead");
            break;
        case 6:
            called(static_cast<bool>(s.set_crosshead_velocity(bytes_.point(0.5, 10))), s, before,
                   "set_crosshead_velocity");
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
            query(s);
            break;
        case 14:
            saveOrRestore(s);
            break;
        case 15: {
            NullCanvas paper;
            paper.throws = bytes_.chance(60);
            bridge::DrawAdapter adapter(paper, bytes_.number(1.0, 60.0, 20));
            DrawOptions options;
            options.tolerance = bytes_.number(1e-6, 1e-3, 20);
            options.metres_per_newton = bytes_.number(0.0, 1.0, 20);
            DebugDraw& canvas = bytes_.chance(128) ? static_cast<DebugDraw&>(paper) : adapter;
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
            e.impulse_threshold = bytes_.number(0.0, 1e-3, 30);
            e.snap_energy = bytes_.number(1e-3, 0.1, 30);
            e.snap_time = bytes_.number(1e-3, 0.3, 30);
            called(static_cast<bool>(s.set_event_settings(e)), s, before, "set_event_settings");
            break;
        }
        case 19:
            if (depth == 0)
                logOrReplay(s);
            break;
        case 20:
            (void)s.post_step();
            ++statistics_.calls;
            break;
        case 21:
            if (depth == 0 && bytes_.chance(40)) { // as a faulty effect would do
                step::World& w = s.world();
                if (&s == other_.get())
                    logComplete_ = false; // not in the log
                addToHistory("NaN written");
                if (!w.rods.empty())
                    w.rods[bytes_.below(static_cast<std::uint32_t>(w.rods.size()))].v[0] =
                        std::numeric_limits<double>::quiet_NaN();
            } else if (depth == 0 && bytes_.chance(40)) { // objects move
                auto moved = std::make_unique<Shells>(std::move(*other_));
                other_ = std::move(moved);
            }
            break;
        case 22:
        case 23:
            changeWorld(world_, *attachment_, bytes_);
            break;
        default: {
            BodyId body = s.body("plate") ? *s.body("plate") : 0;
            if (b2Body* b = bytes_.chance(128) ? someBody(world_, bytes_) : nullptr)
                body = attachment_->body_id(*b);
            const ShellActions::CallResult made =
                shellActions_.act(s, bytes_, {handle(), handle(), bytes_.chance(250) ? body : 77});
            called(made.done, s, before, made.what);
            break;
        }
        }
    }

    ByteSource bytes_;
    ShellActions shellActions_;
    b2World world_;
    std::unique_ptr<bridge::Attachment> attachment_;
    std::unique_ptr<Shells> shells_, other_;
    std::vector<ShellHandle> handles_;
    std::vector<Snapshot> saved_;
    bool logComplete_ = false; ///< the log of the other shells has everything since its start
    Statistics statistics_;
    std::string history_; ///< the last calls, for messages
};

} // namespace

Statistics runSession(const std::vector<std::uint8_t>& bytes) {
    return ApiFuzzer(bytes).run();
}

} // namespace supercircle::fuzz
