#include "plugin/scene/loader/sections.h"

#include <algorithm>
#include <cmath>

namespace supercircle::scene {

namespace {

constexpr std::size_t maxMoves = 100000;

/// Unrolls the moves. `cycle` is the number given to the moves inside a repeat that counts cycles.
class MoveReader {
public:
    MoveReader(Context& context, std::vector<Move>& out) : context_(context), out_(out) {}

    void read(ObjectReader& parent, int cycle) {
        for (const Place& place : parent.array("moves"))
            readOne(place, cycle);
    }

private:
    void readOne(const Place& place, int cycle) {
        ObjectReader reader(context_, *place.node, place.pointer);
        if (!reader.valid())
            return;
        int kinds = 0;
        for (const char* key : {"travel", "hold", "settle", "repeat"})
            kinds += reader.find(key) != nullptr ? 1 : 0;
        if (kinds != 1) {
            context_.error(*place.node, place.pointer, kinds == 0 ? "not a move" : "several moves in one",
                           "one of \"travel\", \"hold\", \"settle\", \"repeat\"");
            reader.ignore({"until", "loading", "cycle", "moves"});
            reader.finish();
            return;
        }
        if (reader.find("travel") != nullptr)
            travel(reader, cycle);
        else if (reader.find("repeat") != nullptr)
            repeat(reader, cycle);
        else
            wait(reader, cycle);
    }

    void travel(ObjectReader& reader, int cycle) {
        Move move;
        move.kind = Move::Kind::Travel;
        move.cycle = cycle;
        const std::size_t before = context_.problems.size();
        move.speed = reader.number("travel", 0.0);
        if (context_.problems.size() == before && move.speed == 0.0)
            context_.error(*reader.find("travel"), reader.pointerTo("travel"), "a travel that does not move",
                           "a speed other than 0, m/s (or \"hold\")");
        move.loading = reader.boolean("loading", move.speed > 0.0);
        if (reader.require("until", "{\"force\": N}, {\"displacement\": m} or {\"time\": s}: what ends the travel"))
            readUntil(reader, move.until);
        reader.finish();
        push(reader, move);
    }

    void readUntil(ObjectReader& reader, Until& until) {
        const Node* node = reader.find("until");
        if (node == nullptr)
            return;
        ObjectReader u(context_, *node, reader.pointerTo("until"));
        if (!u.valid())
            return;
        const bool any = u.find("force") || u.find("displacement") || u.find("time");
        until.force = u.number("force", until.force);
        until.displacement = u.number("displacement", until.displacement);
        until.time = u.number("time", until.time, positive);
        u.finish();
        if (!any)
            context_.error(*node, u.pointer(), "the travel would never end",
                           "at least one of \"force\", \"displacement\", \"time\"");
    }

    void wait(ObjectReader& reader, int cycle) {
        Move move;
        const bool hold = reader.find("hold") != nullptr;
        move.kind = hold ? Move::Kind::Hold : Move::Kind::Settle;
        move.cycle = cycle;
        move.until.time = reader.number(hold ? "hold" : "settle", 0.0, notNegative);
        reader.finish();
        push(reader, move);
    }

    void repeat(ObjectReader& reader, int cycle) {
        const bool counts = reader.boolean("cycle", false);
        if (counts && cycle != 0)
            context_.error(*reader.find("cycle"), reader.pointerTo("cycle"), "cycles inside a cycle",
                           "\"cycle\": true in one level only");
        const std::size_t before = context_.problems.size();
        const auto times = reader.integer("repeat", 1, 0, static_cast<std::int64_t>(maxMoves));
        reader.require("moves", "an array of moves");
        reader.find("moves");
        reader.finish();
        for (std::int64_t i = 0; i < times; ++i) {
            const std::size_t moves = out_.size();
            read(reader, counts ? nextCycle_++ : cycle);
            // Once is enough to report what is wrong, and nothing repeated stays nothing (nested, it would take for
            // ever).
            if (context_.problems.size() != before || tooMany_ || out_.size() == moves)
                return;
        }
    }

    void push(const ObjectReader& reader, const Move& move) {
        if (out_.size() < maxMoves) {
            out_.push_back(move);
        } else if (!tooMany_) {
            tooMany_ = true;
            context_.error(reader.node(), reader.pointer(), "too many moves",
                           "at most " + std::to_string(maxMoves) + " after unrolling");
        }
    }

    Context& context_;
    std::vector<Move>& out_;
    int nextCycle_ = 1;
    bool tooMany_ = false;
};

void checkMachine(Context& context, ObjectReader& reader, const Scene& scene, const Protocol& protocol) {
    const bool holds =
        std::any_of(scene.holds.begin(), scene.holds.end(), [](const HoldDef& h) { return h.on_machine; });
    const Node* body = reader.find("body");
    if (body == nullptr) {
        const bool travels = std::any_of(protocol.moves.begin(), protocol.moves.end(),
                                         [](const Move& m) { return m.kind == Move::Kind::Travel; });
        if (travels && !holds)
            context.error(reader.node(), reader.pointer(), "the machine travels but carries nothing",
                          "\"body\" (a kinematic body), or a hold with \"on_machine\": true");
        return;
    }
    if (body->kind != Node::Kind::String)
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
        context.error(*body, reader.pointerTo("body"), "there is no body named \"" + protocol.body + "\"", {},
                      nearestName(protocol.body, names));
    else if (count > 1)
        context.error(*body, reader.pointerTo("body"),
                      std::to_string(count) + " bodies are named \"" + protocol.body + "\"",
                      "a name that only one body has");
    if (holds)
        context.error(*body, reader.pointerTo("body"), "both a body and holds are on the machine",
                      "either \"body\" or holds with \"on_machine\": true");
}

} // namespace

void readProtocol(Context& context, ObjectReader& top, const Scene& scene, std::optional<Protocol>& out) {
    const Node* node = top.find("protocol");
    if (node == nullptr) {
        for (const HoldDef& h : scene.holds)
            if (h.on_machine)
                context.note(context.document.root, "/hold", "a hold is on the machine, but no \"protocol\" drives it");
        return;
    }
    ObjectReader reader(context, *node, "/protocol");
    Protocol protocol;
    protocol.body = reader.string("body", "");
    const Eigen::Vector2d direction = reader.vector("direction", {protocol.direction.x, protocol.direction.y});
    if (direction.norm() > 0.0)
        protocol.direction = {direction.x() / direction.norm(), direction.y() / direction.norm()};
    else
        context.error(*reader.find("direction"), "/protocol/direction", "no direction", "a vector other than 0");
    protocol.zero_at_touch = reader.boolean("zero_at_touch", protocol.zero_at_touch);
    protocol.approach_speed = reader.number("approach_speed", protocol.approach_speed, notNegative);
    protocol.touch_gap = reader.number("touch_gap", protocol.touch_gap, positive);
    reader.require("moves", "an array of moves");
    MoveReader(context, protocol.moves).read(reader, 0);
    checkMachine(context, reader, scene, protocol);
    reader.finish();
    out = std::move(protocol);
}

void readNumerics(Context& context, ObjectReader& top, Numerics& out) {
    const Node* node = top.find("numerics");
    if (node == nullptr)
        return;
    ObjectReader reader(context, *node, "/numerics");
    out.dt_max = reader.number("dt_max", out.dt_max, positive);
    out.dt_min = reader.number("dt_min", out.dt_min, positive);
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
    const Node* node = top.find("report");
    if (node == nullptr)
        return;
    ObjectReader reader(context, *node, "/report");
    out.kind = reportKinds()[reader.choice("kind", reportKinds(), 0)];
    out.R = reader.number("R", out.R, positive);
    out.B = reader.number("B", out.B, notNegative);
    out.sample_dt = reader.number("sample_dt", out.sample_dt, positive);
    reader.finish();
}

} // namespace supercircle::scene
