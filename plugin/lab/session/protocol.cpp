// The testing machine: first touch, the moves of the protocol, scenes without one.

#include "plugin/lab/session/session.h"

#include <algorithm>
#include <cmath>

namespace supercircle::lab {

void Session::touch() {
    const scene::Protocol& p = *scene_.protocol;
    pileHeight_ = pileTop();
    if (!p.zero_at_touch)
        return;
    phase_ = "approach";
    step::World& w = shells_.world();
    const double free = machineBottom() - pileTop();
    if (free > p.touch_gap) { // nothing is in the way: put the machine just above the specimen
        const rod::Vec2 jump(0.0, -(free - p.touch_gap));
        for (step::Body& b : w.bodies)
            if (b.driven) {
                b.state.centre += jump;
                host_->drive(b.id, b.state.centre, b.state.angle, rod::Vec2::Zero(), 0.0);
            }
        w.range.clear();
    }
    // the pile may still breathe by a few micrometres: creep until the first force
    const double creep = p.approach_speed > 0.0 ? p.approach_speed : 1e-3;
    shells_.set_machine_velocity({creep * p.direction.x, creep * p.direction.y});
    pace(10.0 * creep); // finely, so that the height at first touch is sharp
    bool touched = false;
    const double start = shells_.time();
    while (!touched && shells_.time() - start < 1.0 + (p.touch_gap + 1e-3) / creep)
        if (!frame(frame_, [&] { return touched = force() > 0.0; }))
            return;
    shells_.set_machine_velocity({0.0, 0.0});
    pileHeight_ = machineBottom();
}

void Session::play(const scene::Move& move, std::size_t number) {
    const scene::Protocol& p = *scene_.protocol;
    const double speed = move.kind == scene::Move::Kind::Travel ? move.speed : 0.0;
    if (speed != 0.0)
        back_ = speed < 0.0;
    shells_.set_machine_velocity({speed * p.direction.x, speed * p.direction.y});
    double branch =
        std::isfinite(move.until.displacement) ? std::abs(move.until.displacement - travel()) : 0.25 * pileHeight_;
    if (std::isfinite(move.until.force)) // whichever comes first; a travel may stand far away, as a limit
        branch = std::min(branch, 0.25 * pileHeight_);
    if (std::isfinite(move.until.time))
        branch = std::min(branch, std::abs(speed) * move.until.time);
    pace(speed, branch > 0.0 ? branch : scene_.report.R);
    loading_ = move.loading;
    release_.restart();
    phase_ = move.kind == scene::Move::Kind::Travel
                 ? (speed > 0.0 ? "load " : "unload ") + std::to_string(std::max(1, move.cycle))
                 : (move.kind == scene::Move::Kind::Hold ? "hold" : "settle");
    const std::size_t firstRow = out_.series.rows();
    const double start = shells_.time();
    const double travelAtStart = travel();
    bool done = false;
    const auto reachedForce = [&] { return done = force() >= move.until.force; };
    const std::size_t total = std::max<std::size_t>(1, p.moves.size());
    int count = 0;
    while (!done) {
        double dt = frame_;
        double left = move.until.time - (shells_.time() - start);
        if (speed != 0.0 && std::isfinite(move.until.displacement))
            left = std::min(left, (move.until.displacement - travel()) / speed);
        if (left <= 1e-6 * dt)
            break;
        if (left < dt * (1.0 + 1e-6)) // the last frame ends where the move does; no sliver of a frame is left over
            dt = left;
        if (!frame(dt, std::isfinite(move.until.force) ? std::function<bool()>(reachedForce) : nullptr))
            break;
        if (move.kind == scene::Move::Kind::Settle) {
            double fastest = 0.0;
            for (const step::Rod& r : shells_.world().rods)
                fastest = std::max(fastest, r.speed);
            if (fastest < 1e-4 && shells_.time() - start > 0.05)
                break;
        }
        if (++count % 25 == 0) {
            const double part =
                speed >= 0.0 ? travel() / (5.0 * out_.R) : 1.0 - travel() / std::max(travelAtStart, 1e-9);
            report(0.3 + 0.7 * (static_cast<double>(number) + std::clamp(part, 0.0, 1.0)) / static_cast<double>(total));
        }
    }
    legs_.emplace_back(firstRow, out_.series.rows());
    legMove_.push_back(static_cast<int>(number));
    record::Event e;
    e.time = shells_.time();
    e.displacement = travel();
    e.force = force();
    e.kind = "reversal";
    e.text = "end of " + phase_;
    if (move.kind == scene::Move::Kind::Travel)
        out_.events.push_back(e);
    keep(true);
    if (move.loading && out_.keyFrames[1] < 0)
        out_.keyFrames[1] = static_cast<std::int32_t>(out_.frames.size()) - 1;
}

void Session::protocol() {
    cpuProtocol_ = cpuClock();
    countProtocol_ = shells_.world().counters;
    if (!scene_.protocol) {
        phase_ = "free";
        inProtocol_ = true;
        atStart_ = shells_.world().ledger;
        keep(true);
        out_.keyFrames[0] = static_cast<std::int32_t>(out_.frames.size()) - 1;
        const double start = shells_.time();
        int count = 0;
        while (scene_.duration - (shells_.time() - start) > 1e-12) {
            if (!frame(std::min(frame_, scene_.duration - (shells_.time() - start)), {}))
                return;
            if (creepStart_ < 0.0 && shells_.time() - start > 0.25 * scene_.duration) {
                creepStart_ = shells_.time();
                for (const step::Rod& r : shells_.world().rods)
                    for (int i = 0; i <= r.model.elements(); ++i)
                        creepFrom_.push_back(r.kin.node(i));
            }
            if (++count % 25 == 0)
                report((shells_.time() - start) / scene_.duration);
        }
        keep(true);
        return;
    }
    touch();
    if (end_ != End::Done)
        return;
    const rod::Vec2 t = shells_.world().machineTravel;
    zeroTravel_ = t.x() * scene_.protocol->direction.x + t.y() * scene_.protocol->direction.y;
    inProtocol_ = true;
    atStart_ = shells_.world().ledger;
    sample();
    keep(true);
    out_.keyFrames[0] = static_cast<std::int32_t>(out_.frames.size()) - 1;
    for (std::size_t i = 0; i < scene_.protocol->moves.size() && end_ == End::Done; ++i)
        play(scene_.protocol->moves[i], i);
}

} // namespace supercircle::lab
