// The state of a run for checkpoints: that of the shells (plugin/api/snapshot.cpp), the poses of moving bodies in the
// host, and what the session itself counts, records and remembers. What the constructor and populate() make of the
// scene alone is left out.

#include "plugin/api/snapshot_counts.h"
#include "plugin/lab/session/session.h"

#include <bit>

namespace supercircle::archive {

template <class Ar>
void io(Ar& ar, Is<float> auto& x) {
    if constexpr (Ar::kLoads)
        x = std::bit_cast<float>(static_cast<std::uint32_t>(ar.word(4)));
    else
        ar.word(std::bit_cast<std::uint32_t>(x), 4);
}

template <class Ar>
void io(Ar& ar, Is<record::ShellPose> auto& p) {
    auto& [start, angle, curvature, energy] = p;
    ar(start, angle, curvature, energy);
}

template <class Ar>
void io(Ar& ar, Is<record::BodyPose> auto& p) {
    auto& [x, y, angle] = p;
    ar(x, y, angle);
}

template <class Ar>
void io(Ar& ar, Is<record::ContactMark> auto& c) {
    auto& [x, y, fx, fy, slips] = c;
    ar(x, y, fx, fy, slips);
}

template <class Ar>
void io(Ar& ar, Is<record::Frame> auto& f) {
    auto& [time, displacement, force, phase, shells, bodies, contacts] = f;
    ar(time, displacement, force, phase, shells, bodies, contacts);
}

template <class Ar>
void io(Ar& ar, Is<record::Event> auto& e) {
    auto& [time, displacement, force, kind, text] = e;
    ar(time, displacement, force, kind, text);
}

} // namespace supercircle::archive

namespace supercircle::lab {

/// One list of members for saving and loading.
template <class Self, class Archive>
void Session::io(Self& s, Archive& ar) {
    auto& [part, start, dropped, segment, firstRow, travelAtStart] = s.at_;
    ar(part, start, dropped, segment, firstRow, travelAtStart);
    ar(s.out_.series.columns, s.out_.frames, s.out_.events, s.out_.keyFrames);
    effects::SensorChain::state(s.sensor_, ar);
    EnergyRelease::state(s.energyRelease_, ar);
    ar(s.phase_, s.reversed_, s.inProtocol_, s.loading_, s.zeroTravel_, s.pileHeight_, s.nextFrameTime_,
       s.nextSampleTime_, s.frame_, s.energyAtStart_, s.segmentRows_, s.segmentIndex_, s.creepStart_,
       s.firstFrequencies_, s.unitDamping_, s.creepFrom_, s.sampleTravel_, s.rawForce_, s.largestForce_,
       s.countersAtProtocol_);
}

Session::Bodies Session::movingBodies() const {
    std::vector<step::BodyOutline> all;
    host_->everything(all);
    Bodies moving;
    for (const step::BodyOutline& o : all)
        if (step::BodyState b; (moving.empty() || moving.back().first != o.body) && host_->state(o.body, b) && b.moving)
            moving.emplace_back(o.body, b);
    return moving;
}

std::vector<std::uint8_t> Session::saveState() {
    archive::Saver out;
    out(shells_.save().bytes(), random_.state());
    const Bodies bodies = movingBodies();
    std::vector<step::BodyId> moving;
    for (const auto& [id, b] : bodies)
        moving.push_back(id);
    out(moving);
    for (const auto& [id, b] : bodies)
        out(b.centre, b.angle, b.velocity, b.spin);
    io(*this, out);
    const Spent spent = this->spent();
    out(spent.wall, spent.cpu, spent.protocolCpu, spent.stages);
    return std::move(out.bytes);
}

Status Session::restoreState(const std::vector<std::uint8_t>& state) {
    archive::Loader in(state.data(), state.size());
    std::vector<std::uint8_t> shells;
    std::string random;
    std::vector<step::BodyId> moving;
    in(shells, random, moving);
    std::vector<step::BodyState> states(in.fault().empty() ? moving.size() : 0);
    for (step::BodyState& b : states)
        in(b.centre, b.angle, b.velocity, b.spin);
    io(*this, in);
    in(earlier_.wall, earlier_.cpu, earlier_.protocolCpu, earlier_.stages);
    if (!in.fault().empty() || in.left() != 0 || !random_.setState(random))
        return Status::failure("the checkpoint cannot be read: " +
                               (in.fault().empty() ? "it does not end where it should" : in.fault()));
    const Result<Snapshot> snapshot = Snapshot::from_bytes(std::move(shells));
    if (!snapshot)
        return Status::failure(snapshot.error());
    for (std::size_t i = 0; i < moving.size(); ++i)
        host_->put(moving[i], states[i]);
    if (Status restored = shells_.restore(*snapshot); !restored)
        return restored;
    for (ForceHandle& force : released_)
        force.world = shells_.id();
    out_.shells.clear();
    for (std::size_t i = 0; i < shells_.world().rods.size(); ++i)
        addShellInfo(i);
    if (at_.part >= Part::Approach)
        cpuAtProtocol_ = cpuStart_;
    resumes_ = true;
    return {};
}

Session::Spent Session::spent() {
    Spent now = earlier_;
    const double cpu = cpuSeconds();
    now.wall += wallSeconds() - wallStart_;
    now.cpu += cpu - cpuStart_;
    if (cpuAtProtocol_ >= 0.0)
        now.protocolCpu += cpu - cpuAtProtocol_;
    for (std::size_t i = 0; i < now.stages.size(); ++i)
        now.stages[i] += shells_.stepper().times()[i];
    return now;
}

/// Before a frame: writes the state where it is time to, or where the run is interrupted.
void Session::keepCheckpoint() {
    const CheckpointOptions& o = options_.checkpoint;
    if (!o.file || (!interrupted() && wallSeconds() - lastCheckpoint_ < o.interval))
        return;
    if (const Status written = o.file->write(saveState()); !written && o.onFailure)
        o.onFailure(written.error());
    lastCheckpoint_ = wallSeconds();
}

} // namespace supercircle::lab
