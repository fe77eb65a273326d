#include "plugin/scene/loader/sections.h"
#include "supercircle/support/names.h"

#include <algorithm>
#include <cmath>

namespace supercircle::scene {

namespace {

constexpr std::size_t maxSegments = 100000;

/// Unrolls the segments of a protocol. `cycle` is the number of those inside a repeat that counts cycles.
class SegmentReader {
public:
    SegmentReader(Context& context, std::vector<ProtocolSegment>& out) : context_(context), out_(out) {}

    void read(ObjectReader& parent, int cycle) {
        for (const ArrayItem& item : parent.array("segments"))
            readOne(item, cycle);
    }

private:
    void readOne(const ArrayItem& item, int cycle) {
        ObjectReader reader(context_, item.node, item.pointer);
        if (!reader.valid())
            return;
        reader.renamed("travel", "speed_m_s");
        reader.renamed("until", "stop_when");
        reader.renamed("moves", "segments");
        int kinds = 0;
        for (const char* key : {"speed_m_s", "hold", "settle", "repeat"})
            kinds += reader.find(key) ? 1 : 0;
        if (kinds != 1) {
            context_.error(item.node, item.pointer, kinds == 0 ? "a segment of no kind" : "a segment of several kinds",
                           "one of \"speed_m_s\", \"hold\", \"settle\", \"repeat\"");
            reader.ignore({"stop_when", "loading", "cycle", "segments"});
            reader.finish();
            return;
        }
        if (reader.find("speed_m_s"))
            travel(reader, cycle);
        else if (reader.find("repeat"))
            repeat(reader, cycle);
        else
            wait(reader, cycle);
    }

    void travel(ObjectReader& reader, int cycle) {
        ProtocolSegment segment;
        segment.kind = ProtocolSegment::Kind::Travel;
        segment.cycle = cycle;
        const std::size_t before = context_.errors();
        segment.speed = reader.number("speed_m_s", 0.0);
        if (context_.errors() == before && segment.speed == 0.0)
            context_.error(*reader.find("speed_m_s"), reader.pointerTo("speed_m_s"), "a segment that does not move",
                           "a speed other than 0, m/s (or \"hold\")");
        segment.loading = reader.boolean("loading", segment.speed > 0.0);
        if (reader.require("stop_when",
                           "{\"force\": N}, {\"displacement\": m} or {\"time\": s}: the end of the segment"))
            readStop(reader, segment.stop_when);
        reader.finish();
        push(reader, segment);
    }

    void readStop(ObjectReader& reader, StopCondition& stop) {
        const std::optional<Node> node = reader.find("stop_when");
        if (!node)
            return;
        ObjectReader conditions(context_, *node, reader.pointerTo("stop_when"));
        if (!conditions.valid())
            return;
        const bool any = conditions.find("force") || conditions.find("displacement") || conditions.find("time");
        stop.force = conditions.number("force", stop.force);
        stop.displacement = conditions.number("displacement", stop.displacement);
        stop.time = conditions.number("time", stop.time, positive);
        conditions.finish();
        if (!any)
            context_.error(*node, conditions.pointer(), "the segment would never end",
                           "at least one of \"force\", \"displacement\", \"time\"");
    }

    void wait(ObjectReader& reader, int cycle) {
        ProtocolSegment segment;
        const bool hold = reader.find("hold").has_value();
        segment.kind = hold ? ProtocolSegment::Kind::Hold : ProtocolSegment::Kind::Settle;
        segment.cycle = cycle;
        segment.stop_when.time = reader.number(hold ? "hold" : "settle", 0.0, notNegative);
        reader.finish();
        push(reader, segment);
    }

    void repeat(ObjectReader& reader, int cycle) {
        const bool counts = reader.boolean("cycle", false);
        if (counts && cycle != 0)
            context_.error(*reader.find("cycle"), reader.pointerTo("cycle"), "cycles inside a cycle",
                           "\"cycle\": true in one level only");
        const std::size_t before = context_.errors();
        const auto times = reader.integer("repeat", 1, 0, static_cast<std::int64_t>(maxSegments));
        reader.require("segments", "an array of segments");
        reader.find("segments");
        reader.finish();
        for (std::int64_t i = 0; i < times; ++i) {
            const std::size_t segments = out_.size();
            read(reader, counts ? nextCycle_++ : cycle);
            // An error is reported once, and repeats of nothing end at once (nested ones would take very long).
            if (context_.errors() != before || tooMany_ || out_.size() == segments)
                return;
        }
    }

    void push(const ObjectReader& reader, const ProtocolSegment& segment) {
        if (out_.size() < maxSegments) {
            out_.push_back(segment);
        } else if (!tooMany_) {
            tooMany_ = true;
            context_.error(reader.node(), reader.pointer(), "too many segments",
                           "at most " + std::to_string(maxSegments) + " after unrolling");
        }
    }

    Context& context_;
    std::vector<ProtocolSegment>& out_;
    int nextCycle_ = 1;
    bool tooMany_ = false;
};

void checkCrosshead(Context& context, ObjectReader& reader, const Scene& scene, const Protocol& protocol) {
    const bool holds = std::any_of(scene.holds.begin(), scene.holds.end(),
                                   [](const HoldDef& h) { return h.base == HoldBase::Moving; });
    const std::optional<Node> body = reader.find("body");
    if (!body) {
        const bool travels =
            std::any_of(protocol.segments.begin(), protocol.segments.end(),
                        [](const ProtocolSegment& s) { return s.kind == ProtocolSegment::Kind::Travel; });
        if (travels && !holds)
            context.error(reader.node(), reader.pointer(), "nothing is attached to the moving crosshead",
                          "\"body\" (a kinematic body), or a hold with \"base\": \"moving\"");
        return;
    }
    if (body->kind() != Node::Kind::String)
        return; // reported already
    std::vector<std::string> names;
    int count = 0;
    for (const auto& b : scene.rigid.bodies) {
        if (!b.name.empty())
            names.push_back(b.name);
        if (b.name != protocol.body)
            continue;
        ++count;
        if (b.type != step::BodyType::Kinematic)
            context.error(*body, reader.pointerTo("body"), "the body \"" + protocol.body + "\" is not kinematic",
                          "a body of type 1");
    }
    if (count == 0)
        context.error(*body, reader.pointerTo("body"), "there is no body named \"" + protocol.body + "\"",
                      "the name of a body of type 1, or no \"body\": then the holds move",
                      nearestName(protocol.body, names));
    else if (count > 1)
        context.error(*body, reader.pointerTo("body"),
                      std::to_string(count) + " bodies are named \"" + protocol.body + "\"",
                      "a name that only one body has");
    if (holds)
        context.error(*body, reader.pointerTo("body"), "both a body and holds are attached to the crosshead",
                      "either \"body\" or holds with \"base\": \"moving\"");
}

} // namespace

void readProtocol(Context& context, ObjectReader& top, const Scene& scene, std::optional<Protocol>& out) {
    const std::optional<Node> node = top.find("protocol");
    if (!node) {
        for (const HoldDef& h : scene.holds)
            if (h.base == HoldBase::Moving)
                context.note(context.document.root(), "/hold",
                             "a hold is attached to the crosshead, but no \"protocol\" moves it");
        return;
    }
    ObjectReader reader(context, *node, "/protocol");
    reader.renamed("moves", "segments");
    reader.renamed("zero_at_touch", "zero_at_first_contact");
    reader.renamed("touch_gap", "approach_gap");
    Protocol protocol;
    protocol.body = reader.string("body", "");
    const Eigen::Vector2d direction = reader.vector("direction", {protocol.direction.x, protocol.direction.y});
    if (direction.norm() > 0.0)
        protocol.direction = {direction.x() / direction.norm(), direction.y() / direction.norm()};
    else
        context.error(*reader.find("direction"), "/protocol/direction", "no direction", "a vector other than 0");
    protocol.zero_at_first_contact = reader.boolean("zero_at_first_contact", protocol.zero_at_first_contact);
    protocol.approach_speed = reader.number("approach_speed", protocol.approach_speed, notNegative);
    protocol.approach_gap = reader.number("approach_gap", protocol.approach_gap, positive);
    reader.require("segments", "an array of segments");
    SegmentReader(context, protocol.segments).read(reader, 0);
    checkCrosshead(context, reader, scene, protocol);
    reader.finish();
    out = std::move(protocol);
}

void readNumerics(Context& context, ObjectReader& top, Numerics& out) {
    const std::optional<Node> node = top.find("numerics");
    if (!node)
        return;
    ObjectReader reader(context, *node, "/numerics");
    out.accuracy = static_cast<Accuracy>(reader.choice("accuracy", kAccuracies, 0));
    out.dt_max = reader.number("dt_max", out.dt_max, positive);
    out.dt_min = reader.number("dt_min", out.dt_min, positive);
    if (reader.find("quasi_static"))
        out.quasi_static = reader.boolean("quasi_static", false);
    out.fixed_dt = reader.number("fixed_dt", out.fixed_dt, notNegative);
    out.tolerance = reader.number("tolerance", out.tolerance, positive);
    out.position_tolerance = reader.number("position_tolerance", out.position_tolerance, positive);
    reader.finish();
    if (out.dt_max > 0.0 && out.dt_min > out.dt_max)
        context.error(*node, "/numerics", "the range of steps is empty", "dt_min <= dt_max");
}

const std::vector<std::string>& reportKinds() {
    static const std::vector<std::string> kinds = {"free", "stack", "snap", "squeeze", "cantilever", "pinning", "ramp"};
    return kinds;
}

void readReport(Context& context, ObjectReader& top, Report& out) {
    const std::optional<Node> node = top.find("report");
    if (!node)
        return;
    ObjectReader reader(context, *node, "/report");
    out.kind = reportKinds()[reader.choice("kind", reportKinds(), 0)];
    out.R = reader.number("R", out.R, positive);
    out.B = reader.number("B", out.B, notNegative);
    out.sample_dt = reader.number("sample_dt", out.sample_dt, positive);
    reader.finish();
}

} // namespace supercircle::scene
