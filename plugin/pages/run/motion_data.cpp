#include "plugin/pages/run/motion_data.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <set>

#include "plugin/graphics/colour_map.h"
#include "plugin/pages/run/figures.h"
#include "plugin/pages/run/geometry.h"
#include "plugin/recording/table/text.h"
#include "supercircle/support/order_statistics.h"

// Shapes are stored as 16-bit increments of the running tangent angle, poses as 32-bit floats (decision 0177).

namespace supercircle::pages {

using namespace graphics;

namespace {

using record::ContactMark;
using record::Frame;
using record::Recording;

template <typename T>
std::string packed(const std::vector<T>& values) {
    static_assert(sizeof(T) <= 4);
    std::vector<unsigned char> bytes(values.size() * sizeof(T));
    if (!values.empty())
        std::memcpy(bytes.data(), values.data(), bytes.size());
    return base64(bytes);
}

constexpr double kFinestTurn = 2.0 * 3.14159265358979323846 / 32768.0;
constexpr std::size_t kMostContacts = 400; ///< per frame: more cannot be distinguished

/// Contacts drawn as arrows: the strongest ones, in their order.
std::vector<ContactMark> strongContacts(const Frame& frame) {
    const auto size = [](const ContactMark& c) { return std::hypot(c.fx, c.fy); };
    std::vector<double> sizes;
    for (const ContactMark& contact : frame.contacts)
        if (std::isfinite(size(contact)))
            sizes.push_back(size(contact));
    std::sort(sizes.begin(), sizes.end(), std::greater<>());
    if (sizes.empty())
        return {};
    const double least = std::max(2e-3 * sizes.front(), sizes.size() > kMostContacts ? sizes[kMostContacts] : 0.0);
    std::vector<ContactMark> strong;
    for (const ContactMark& contact : frame.contacts)
        if (size(contact) > least && std::isfinite(contact.x) && std::isfinite(contact.y))
            strong.push_back(contact);
    return strong;
}

/// Lengths of a shell's elements; equal ones, as many as the first pose has curvatures, where the shell names none.
std::vector<double> drawnElements(const Recording& recording, std::size_t shell) {
    const auto& info = recording.shells[shell];
    if (!info.element_length.empty())
        return info.element_length;
    for (const Frame& frame : recording.frames)
        if (shell < frame.shells.size())
            return elementLengths(info, frame.shells[shell].curvature.size());
    return {};
}

std::size_t frameBytes(const Frame& frame) {
    std::size_t bytes = 16 + 12 * frame.bodies.size() + 8 * std::min(frame.contacts.size(), kMostContacts) / 2;
    for (const auto& shell : frame.shells)
        bytes += 16 + 2 * shell.curvature.size();
    return bytes * 4 / 3;
}

/// Columns of the player's data, frame after frame.
struct Columns {
    std::vector<float> times, displacements, forces, poses, bodies;
    std::vector<std::uint16_t> phases, shellCounts, contactCounts;
    std::vector<std::int16_t> turns, contacts;
};

struct Scales {
    double turn = kFinestTurn;
    double x0 = 0.0, y0 = 0.0, length = 1.0; ///< of contact points, m
    double force = 0.0;                      ///< largest contact force, N
    double bend = 0.0;                       ///< curvature change that fills the colour scale, 1/m
};

Scales scalesOf(const Recording& recording, const std::vector<std::size_t>& frames, const View& view) {
    Scales scales;
    double most = 0.0;
    std::vector<double> changes;
    for (const std::size_t index : frames) {
        const Frame& frame = recording.frames[index];
        for (std::size_t i = 0; i < std::min(frame.shells.size(), recording.shells.size()); ++i) {
            const auto& curvature = frame.shells[i].curvature;
            const auto lengths = elementLengths(recording.shells[i], curvature.size());
            const auto& natural = recording.shells[i].natural_curvature;
            for (std::size_t k = 0; k < curvature.size(); ++k)
                if (const double kappa = curvature[k]; std::isfinite(kappa)) {
                    most = std::max(most, std::abs(kappa * lengths[k]));
                    changes.push_back(std::abs(kappa - (natural.size() == curvature.size() ? natural[k] : 0.0)));
                }
        }
        for (const ContactMark& contact : frame.contacts)
            if (const double f = std::hypot(contact.fx, contact.fy); std::isfinite(f))
                scales.force = std::max(scales.force, f);
    }
    scales.turn = std::max(kFinestTurn, std::min(most, 1e4) / 32000.0);
    if (!changes.empty()) // a quantile: one kink in one frame must not set the colour scale
        scales.bend = lowerQuantile(std::move(changes), 0.995);
    scales.x0 = 0.5 * (view.x.lo + view.x.hi);
    scales.y0 = 0.5 * (view.y.lo + view.y.hi);
    scales.length = std::max(view.x.span(), view.y.span()) / 65000.0;
    return scales;
}

std::int16_t small(double value) {
    return static_cast<std::int16_t>(std::lround(std::clamp(std::isfinite(value) ? value : 0.0, -32767.0, 32767.0)));
}

void addShells(Columns& columns, const Recording& recording, const Frame& frame, const Scales& scales) {
    const std::size_t count = std::min(frame.shells.size(), recording.shells.size());
    columns.shellCounts.push_back(static_cast<std::uint16_t>(std::min<std::size_t>(count, 65535)));
    for (std::size_t i = 0; i < columns.shellCounts.back(); ++i) {
        const auto& pose = frame.shells[i];
        const double angle = std::remainder(pose.angle, 2.0 * 3.14159265358979323846);
        for (const double value : {pose.start[0], pose.start[1], angle, pose.bending_energy})
            columns.poses.push_back(static_cast<float>(value));
        const auto elements = drawnElements(recording, i);
        std::vector<double> turns(elements.size(), 0.0);
        for (std::size_t k = 0; k < std::min(turns.size(), pose.curvature.size()); ++k)
            turns[k] = elements[k] * static_cast<double>(pose.curvature[k]);
        for (const int turn : quantisedTurns(turns, scales.turn))
            columns.turns.push_back(small(turn));
    }
}

/// Forces are stored as signed square roots of their ratio to the largest, so that an impact leaves precision for the
/// others; the lowest bit of x says "slips".
void addContacts(Columns& columns, const Frame& frame, const Scales& scales) {
    const std::vector<ContactMark> strong = strongContacts(frame);
    columns.contactCounts.push_back(static_cast<std::uint16_t>(strong.size()));
    const auto rooted = [&](double f) {
        return small(std::copysign(std::sqrt(std::abs(f) / std::max(scales.force, 1e-300)), f) * 32767.0);
    };
    for (const ContactMark& contact : strong) {
        const int x = small((contact.x - scales.x0) / scales.length) & ~1;
        columns.contacts.push_back(static_cast<std::int16_t>(x | (contact.slips ? 1 : 0)));
        columns.contacts.push_back(small((contact.y - scales.y0) / scales.length));
        columns.contacts.push_back(rooted(contact.fx));
        columns.contacts.push_back(rooted(contact.fy));
    }
}

class Object {
public:
    std::string text = "{";
    std::string& key(std::string_view name) {
        if (text.size() > 1)
            text += ',';
        record::appendJsonString(text, name);
        return text += ':';
    }
    void number(std::string_view name, double value) { record::appendJsonNumber(key(name), value); }
    void string(std::string_view name, std::string_view value) { record::appendJsonString(key(name), value); }
    template <typename List, typename Append>
    void list(std::string_view name, const List& values, Append append) {
        key(name) += '[';
        bool first = true;
        for (const auto& value : values) {
            text += first ? "" : ",";
            first = false;
            append(text, value);
        }
        text += ']';
    }
};

void appendFloat(std::string& out, double value) {
    const auto rounded = static_cast<float>(value);
    if (std::isfinite(rounded))
        record::appendNumber(out, rounded);
    else
        out += '0';
}

void appendFloats(std::string& out, const std::vector<double>& values) {
    out += '[';
    for (std::size_t i = 0; i < values.size(); ++i) {
        out += i == 0 ? "" : ",";
        appendFloat(out, values[i]);
    }
    out += ']';
}

void describeShells(Object& object, const Recording& recording) {
    std::size_t index = 0;
    object.list("shells", recording.shells, [&](std::string& out, const record::ShellInfo& shell) {
        Object one;
        one.string("name", shell.name);
        appendFloat(one.key("h"), shell.thickness);
        one.key("closed") += shell.closed ? "true" : "false";
        appendFloats(one.key("l"), drawnElements(recording, index++));
        appendFloats(one.key("k0"), shell.natural_curvature);
        out += one.text + "}";
    });
}

void describeOutlines(Object& object, const Recording& recording) {
    const std::vector<bool> driven = drivenBodies(recording);
    object.list("outlines", recording.outlines, [&](std::string& out, const record::OutlineInfo& outline) {
        Object one;
        const auto body = static_cast<std::size_t>(outline.body);
        const bool dark = outline.driven || (outline.body >= 0 && body < driven.size() && driven[body]);
        one.key("kind") += std::to_string(static_cast<int>(outline.kind));
        one.key("body") += std::to_string(outline.body);
        one.key("dark") += dark ? "1" : "0";
        appendFloat(one.key("r"), outline.radius);
        std::vector<double> flat;
        for (const auto& p : outline.points)
            flat.insert(flat.end(), p.begin(), p.end());
        appendFloats(one.key("p"), flat);
        out += one.text + "}";
    });
}

} // namespace

std::string base64(std::span<const unsigned char> bytes) {
    static constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    out.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::size_t have = std::min<std::size_t>(3, bytes.size() - i);
        std::uint32_t word = 0;
        for (std::size_t k = 0; k < 3; ++k)
            word = (word << 8) | (k < have ? bytes[i + k] : 0U);
        for (std::size_t k = 0; k < 4; ++k)
            out += k <= have ? digits[(word >> (18 - 6 * k)) & 63] : '=';
    }
    return out;
}

std::vector<int> quantisedTurns(const std::vector<double>& turns, double unit) {
    std::vector<int> result;
    double angle = 0.0;
    long long before = 0;
    for (const double turn : turns) {
        angle += std::isfinite(turn) ? std::clamp(turn, -1e4, 1e4) : 0.0;
        const long long now = std::llround(angle / unit);
        result.push_back(static_cast<int>(now - before));
        before = now;
    }
    return result;
}

std::vector<std::size_t> keptFrames(const Recording& recording, std::size_t budget) {
    const std::size_t n = recording.frames.size();
    std::size_t bytes = 0;
    for (const Frame& frame : recording.frames)
        bytes += frameBytes(frame);
    const std::size_t stride = std::max<std::size_t>(1, (bytes + budget - 1) / std::max<std::size_t>(budget, 1));
    std::set<std::size_t> kept;
    for (std::size_t i = 0; i < n; i += stride)
        kept.insert(i);
    if (n > 0)
        kept.insert(n - 1);
    for (const std::int32_t key : recording.keyFrames)
        if (key >= 0 && static_cast<std::size_t>(key) < n)
            kept.insert(static_cast<std::size_t>(key));
    return {kept.begin(), kept.end()};
}

std::string motionJson(const Recording& recording, const std::vector<std::size_t>& frames) {
    const View view = viewOf(recording, frames);
    const Scales scales = scalesOf(recording, frames, view);
    Columns columns;
    std::vector<std::string> phases;
    const std::size_t bodies = frames.empty() ? 0 : recording.frames[frames.back()].bodies.size();
    for (const std::size_t index : frames) {
        const Frame& frame = recording.frames[index];
        columns.times.push_back(static_cast<float>(frame.time));
        columns.displacements.push_back(static_cast<float>(frame.displacement));
        columns.forces.push_back(static_cast<float>(frame.force));
        const auto phase = std::find(phases.begin(), phases.end(), frame.phase);
        columns.phases.push_back(static_cast<std::uint16_t>(phase - phases.begin()));
        if (phase == phases.end())
            phases.push_back(frame.phase);
        addShells(columns, recording, frame, scales);
        for (std::size_t b = 0; b < bodies; ++b) {
            const record::BodyPose pose = b < frame.bodies.size() ? frame.bodies[b] : record::BodyPose{};
            for (const double value : {pose.x, pose.y, pose.angle})
                columns.bodies.push_back(static_cast<float>(value));
        }
        addContacts(columns, frame, scales);
    }

    Object object;
    object.list("view", std::vector<double>{view.x.lo, view.x.hi, view.y.lo, view.y.hi}, appendFloat);
    object.number("turnUnit", scales.turn);
    object.list("contactFrame", std::vector<double>{scales.x0, scales.y0, scales.length, scales.force},
                [](std::string& out, double v) { record::appendJsonNumber(out, v); });
    object.number("bendScale", scales.bend);
    object.number("energyScale", largestBendingEnergy(recording));
    object.key("bodyCount") += std::to_string(bodies);
    const auto colours = [&](std::string_view name, auto map, double lo) {
        std::vector<std::string> table;
        for (int i = 0; i <= 64; ++i)
            table.push_back(hexText(map(lo + (1.0 - lo) * i / 64.0)));
        object.list(name, table, [](std::string& out, const std::string& c) { record::appendJsonString(out, c); });
    };
    colours("energyColours", energyColour, 0.0);
    colours("bendColours", signedColour, -1.0);
    object.list("phaseNames", phases, [](std::string& out, const std::string& p) { record::appendJsonString(out, p); });
    describeShells(object, recording);
    describeOutlines(object, recording);
    object.string("t", packed(columns.times));
    object.string("d", packed(columns.displacements));
    object.string("f", packed(columns.forces));
    object.string("phase", packed(columns.phases));
    object.string("counts", packed(columns.shellCounts));
    object.string("poses", packed(columns.poses));
    object.string("turns", packed(columns.turns));
    object.string("bodies", packed(columns.bodies));
    object.string("contactCounts", packed(columns.contactCounts));
    object.string("contacts", packed(columns.contacts));
    std::string safe;
    for (const char c : object.text) // "</script>" inside a name would end the element
        if (c == '<')
            safe += "\\u003c";
        else
            safe += c;
    return safe + "}";
}

} // namespace supercircle::pages
