// The test protocol: approach to first contact, the segments, scenes without a protocol.

#include "plugin/lab/session/session.h"

#include <algorithm>
#include <cmath>

namespace supercircle::lab {

/// Puts the crosshead just above the specimen and lets it go down slowly. False: there is no approach, or the run ends.
bool Session::beginApproach() {
    const scene::Protocol& p = *scene_.protocol;
    pileHeight_ = pileTop();
    if (!p.zero_at_first_contact)
        return false;
    phase_ = "approach";
    step::World& w = shells_.world();
    const double free = crossheadBottom() - pileTop();
    if (free > p.approach_gap) { // no contact on the way: put the crosshead just above the specimen
        const rod::Vec2 jump(0.0, -(free - p.approach_gap));
        for (step::Body& b : w.bodies)
            if (b.driven) {
                b.state.centre += jump;
                host_->drive(b.id, b.state.centre, b.state.angle, rod::Vec2::Zero(), 0.0);
            }
        w.range.clear();
    }
    if (!setCrossheadSpeed(approachSpeed()))
        return false;
    setStepLimits(10.0 * approachSpeed()); // small steps give an exact height at first contact
    at_.start = shells_.time();
    return true;
}

/// The pile may still move by a few micrometres: slow until the first force.
double Session::approachSpeed() const {
    return scene_.protocol->approach_speed > 0.0 ? scene_.protocol->approach_speed : 1e-3;
}

void Session::approach() {
    if (begins() && !beginApproach())
        return;
    const double longest = 1.0 + (scene_.protocol->approach_gap + 1e-3) / approachSpeed();
    bool touched = false;
    while (!touched && shells_.time() - at_.start < longest)
        if (!frame(frame_, [&] { return touched = force() > 0.0; }))
            return;
    shells_.set_crosshead_velocity({0.0, 0.0}).or_fail();
    pileHeight_ = crossheadBottom();
}

bool Session::setCrossheadSpeed(double speed) {
    const Point& direction = scene_.protocol->direction;
    const Status set = shells_.set_crosshead_velocity({speed * direction.x, speed * direction.y});
    if (!set) {
        status_ = RunStatus::BadScene;
        message_ = set.error();
    }
    return static_cast<bool>(set);
}

/// Sets speed, step limits and what is recorded; false: the run ends.
bool Session::beginSegment(const scene::ProtocolSegment& segment) {
    const bool moves = segment.kind == scene::ProtocolSegment::Kind::Travel;
    const double speed = moves ? segment.speed : 0.0;
    if (speed != 0.0)
        reversed_ = speed < 0.0;
    if (!setCrossheadSpeed(speed))
        return false;
    double branch = std::isfinite(segment.stop_when.displacement) ? std::abs(segment.stop_when.displacement - travel())
                                                                  : 0.25 * pileHeight_;
    if (std::isfinite(segment.stop_when.force)) // whichever comes first; a distant displacement may be a mere limit
        branch = std::min(branch, 0.25 * pileHeight_);
    if (std::isfinite(segment.stop_when.time))
        branch = std::min(branch, std::abs(speed) * segment.stop_when.time);
    setStepLimits(speed, branch > 0.0 ? branch : scene_.report.R);
    setAccuracy(speed);
    toRepeat_ = {};
    loading_ = segment.loading;
    energyRelease_.restart();
    phase_ = moves ? (speed > 0.0 ? "load " : "unload ") + std::to_string(std::max(1, segment.cycle))
                   : (segment.kind == scene::ProtocolSegment::Kind::Hold ? "hold" : "settle");
    at_.firstRow = out_.series.rows();
    at_.start = shells_.time();
    at_.travelAtStart = travel();
    return true;
}

void Session::runSegment(const scene::ProtocolSegment& segment, std::size_t number) {
    if (begins() && !beginSegment(segment))
        return;
    const bool moves = segment.kind == scene::ProtocolSegment::Kind::Travel;
    const double speed = moves ? segment.speed : 0.0;
    bool done = false;
    const std::size_t total = std::max<std::size_t>(1, scene_.protocol->segments.size());
    int count = 0;
    while (!done) {
        double dt = frame_;
        double left = segment.stop_when.time - (shells_.time() - at_.start);
        if (speed != 0.0 && std::isfinite(segment.stop_when.displacement))
            left = std::min(left, (segment.stop_when.displacement - travel()) / speed);
        if (left <= 1e-6 * dt)
            break;
        if (left < dt * (1.0 + 1e-6)) // the last frame ends with the segment: no tiny frame remains
            dt = left;
        const double limit = segment.stop_when.force;
        if (std::isfinite(limit) ? !frameToForce(dt, limit, done) : !frame(dt, {}))
            break;
        if (segment.kind == scene::ProtocolSegment::Kind::Settle) {
            double fastest = 0.0;
            for (const step::Rod& r : shells_.world().rods)
                fastest = std::max(fastest, r.speed);
            if (fastest < 1e-4 && shells_.time() - at_.start > 0.05)
                break;
        }
        if (++count % 25 == 0) {
            const double part =
                speed >= 0.0 ? travel() / (5.0 * out_.R) : 1.0 - travel() / std::max(at_.travelAtStart, 1e-9);
            reportProgress(0.3 + 0.7 * (static_cast<double>(number) + std::clamp(part, 0.0, 1.0)) /
                                     static_cast<double>(total));
        }
    }
    segmentRows_.emplace_back(at_.firstRow, out_.series.rows());
    segmentIndex_.push_back(static_cast<int>(number));
    if (moves)
        out_.events.push_back({shells_.time(), travel(), force(), "reversal", "end of " + phase_});
    keepFrame(true);
    if (segment.loading && out_.keyFrames[1] < 0)
        out_.keyFrames[1] = static_cast<std::int32_t>(out_.frames.size()) - 1;
}

void Session::runFree() {
    if (begins()) {
        phase_ = "free";
        inProtocol_ = true;
        energyAtStart_ = shells_.world().energyBalance;
        keepFrame(true);
        out_.keyFrames[0] = static_cast<std::int32_t>(out_.frames.size()) - 1;
        at_.start = shells_.time();
    }
    const double start = at_.start;
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
            reportProgress((shells_.time() - start) / scene_.duration);
    }
    keepFrame(true);
}

void Session::runProtocol() {
    if (at_.part == Part::Start) {
        cpuAtProtocol_ = cpuSeconds();
        countersAtProtocol_ = shells_.world().counters;
        at_.part = scene_.protocol ? Part::Approach : Part::Free;
    }
    if (at_.part == Part::Free)
        return runFree();
    if (at_.part == Part::Approach) {
        approach();
        if (status_ != RunStatus::Done)
            return;
        beginRecording();
        at_.part = Part::Segments;
    }
    for (; at_.segment < scene_.protocol->segments.size() && status_ == RunStatus::Done; ++at_.segment)
        runSegment(scene_.protocol->segments[at_.segment], at_.segment);
}

/// From the first contact on.
void Session::beginRecording() {
    const rod::Vec2 t = shells_.world().crossheadTravel;
    zeroTravel_ = t.x() * scene_.protocol->direction.x + t.y() * scene_.protocol->direction.y;
    inProtocol_ = true;
    energyAtStart_ = shells_.world().energyBalance;
    sample();
    keepFrame(true);
    out_.keyFrames[0] = static_cast<std::int32_t>(out_.frames.size()) - 1;
}

} // namespace supercircle::lab
