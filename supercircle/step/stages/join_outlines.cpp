#include "supercircle/step/stages/join_outlines.h"

#include "supercircle/support/trig.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle::step {

namespace {

void reachOfShells(const World& world, double frame, std::vector<ShellReach>& all) {
    all.clear();
    for (const Rod& r : world.rods) {
        const double thickness = r.model.definition().thickness;
        const double pad =
            2.0 * frame * (r.speed + frame * world.gravity.norm()) + r.model.longestElement() + thickness;
        Vec2 lower = Vec2::Constant(std::numeric_limits<double>::infinity()), upper = -lower;
        for (int i = 0; i <= r.model.elements(); ++i) {
            lower = lower.cwiseMin(r.kin.node(i));
            upper = upper.cwiseMax(r.kin.node(i));
        }
        all.push_back({{lower - Vec2::Constant(pad), upper + Vec2::Constant(pad)}, thickness});
    }
}

/// Thickness of the thinnest shell that may get near an outline, m; 0 if none may.
double thinnestNear(const std::vector<ShellReach>& shells, const contact::Outline& outline) {
    Vec2 lower = outline.points[0], upper = lower;
    for (const Vec2& p : outline.points) {
        lower = lower.cwiseMin(p);
        upper = upper.cwiseMax(p);
    }
    double thinnest = 0.0;
    for (const ShellReach& s : shells)
        if ((thinnest == 0.0 || s.thickness < thinnest) && s.box.lower.x() <= upper.x() + outline.radius &&
            s.box.upper.x() >= lower.x() - outline.radius && s.box.lower.y() <= upper.y() + outline.radius &&
            s.box.upper.y() >= lower.y() - outline.radius)
            thinnest = s.thickness;
    return thinnest;
}

void placePiece(const BodyOutline& raw, const BodyState& body, contact::SeamPiece& piece) {
    piece.body = raw.body;
    piece.key = raw.local.key;
    piece.centre = body.centre;
    piece.velocity = body.velocity;
    piece.spin = body.spin;
    piece.thickness = 0.0;
    place(raw, body.centre, body.angle, piece.outline);
}

void toBody(const BodyState& body, contact::Outline& outline, const contact::Joined& joined) {
    const double c = math::cos(body.angle), s = math::sin(body.angle);
    const auto turn = [&](const Vec2& d) { return Vec2(c * d.x() + s * d.y(), c * d.y() - s * d.x()); };
    if (joined.moved)
        for (std::size_t k = 0; k < outline.points.size(); ++k)
            outline.points[k] = turn(joined.points[k] - body.centre);
    outline.seams = joined.seams;
    for (contact::VertexSeam& v : outline.seams.vertices) {
        v.c1 = turn(v.c1);
        v.c2 = turn(v.c2);
    }
}

bool inside(const Vec2& p, const Box& box) {
    return (p.array() >= box.lower.array()).all() && (p.array() <= box.upper.array()).all();
}

const BodyState* stateOf(BodyId id, const std::vector<Body>& bodies) {
    const auto it =
        std::lower_bound(bodies.begin(), bodies.end(), id, [](const Body& b, BodyId want) { return b.id < want; });
    return it != bodies.end() && it->id == id ? &it->state : nullptr;
}

/// Appends what touches the vertices of outlines that lie beyond the region that was read. More than that does no harm,
/// and one query is cheaper than one for each vertex.
void queryVertices(const Port& port, const Box& read, double tolerance, const std::vector<Vec2>& vertices,
                   std::vector<BodyOutline>& out) {
    const Vec2 reach = Vec2::Constant(tolerance);
    Box hull{Vec2::Constant(std::numeric_limits<double>::infinity()), Vec2::Constant(0.0)};
    hull.upper = -hull.lower;
    bool any = false;
    for (const Vec2& p : vertices) {
        if (inside(p, read))
            continue;
        any = true;
        hull.lower = hull.lower.cwiseMin(p - reach);
        hull.upper = hull.upper.cwiseMax(p + reach);
    }
    if (any)
        port.query(hull, out);
}

/// The vertices whose neighbours decide where they are.
void listVertices(const contact::Outline& outline, std::vector<Vec2>& out) {
    if (outline.kind != contact::OutlineKind::Circle)
        out.insert(out.end(), outline.points.begin(), outline.points.end());
}

/// Sorts what was found and leaves out what is known.
void onlyNew(const std::vector<BodyOutline>& known, std::vector<BodyOutline>& found) {
    std::sort(found.begin(), found.end(), before);
    const auto same = [](const BodyOutline& a, const BodyOutline& b) { return !before(a, b) && !before(b, a); };
    found.erase(std::unique(found.begin(), found.end(), same), found.end());
    std::erase_if(found,
                  [&](const BodyOutline& o) { return std::binary_search(known.begin(), known.end(), o, before); });
}

/// Adds what outlines near shells touch beyond the region that was read, and what that touches: the far vertices of
/// an outline decide how its faces lie under a shell. `raw` holds what the pieces are.
void readBeyond(const Port& port, const Box& read, const std::vector<Body>& bodies, std::vector<BodyOutline>& found,
                std::vector<BodyOutline>& raw, std::vector<contact::SeamPiece>& pieces, std::vector<Vec2>& farther) {
    double tolerance = 0.0;
    for (const contact::SeamPiece& piece : pieces)
        tolerance = std::max(tolerance, contact::kSeamTolerance * piece.thickness);
    found.clear();
    farther.clear();
    for (const contact::SeamPiece& piece : pieces)
        if (piece.thickness > 0.0)
            listVertices(piece.outline, farther);
    queryVertices(port, read, tolerance, farther, found);
    for (int hop = 0; !found.empty() && hop < 2; ++hop) {
        onlyNew(raw, found);
        farther.clear();
        for (const BodyOutline& o : found) {
            BodyState own;
            const BodyState* state = stateOf(o.body, bodies);
            if (state == nullptr && !port.state(o.body, own))
                continue;
            const auto at = std::lower_bound(raw.begin(), raw.end(), o, before) - raw.begin();
            raw.insert(raw.begin() + at, o);
            contact::SeamPiece& piece = *pieces.insert(pieces.begin() + at, contact::SeamPiece{});
            placePiece(o, state != nullptr ? *state : own, piece);
            listVertices(piece.outline, farther);
        }
        found.clear();
        if (hop == 0)
            queryVertices(port, read, tolerance, farther, found);
    }
}

/// Marks the pieces that differ from those of the last frame.
void markChanged(double frame, const OutlineJoining& last, const std::vector<BodyOutline>& raw,
                 std::vector<contact::SeamPiece>& pieces) {
    std::size_t k = 0;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        while (k < last.raw.size() && before(last.raw[k], raw[i]))
            ++k;
        contact::SeamPiece& now = pieces[i];
        now.changed = true;
        if (k == last.raw.size() || !(last.raw[k] == raw[i]))
            continue;
        const contact::SeamPiece& old = last.pieces[k];
        const bool still = now.velocity == Vec2::Zero() && now.spin == 0.0; // then the length of the frame is nothing
        now.changed = old.outline.points != now.outline.points || old.thickness != now.thickness ||
                      old.velocity != now.velocity || old.spin != now.spin || (!still && frame != last.frame);
    }
}

} // namespace

void joinOutlines(const World& world, const Port& port, const Box& read, const std::vector<Body>& bodies, double frame,
                  OutlineJoining& joining, std::vector<BodyOutline>& outlines) {
    reachOfShells(world, frame, joining.shells);
    std::vector<contact::SeamPiece>& pieces = joining.next;
    pieces.resize(outlines.size());
    for (std::size_t i = 0; i < outlines.size(); ++i) {
        placePiece(outlines[i], *stateOf(outlines[i].body, bodies), pieces[i]);
        pieces[i].thickness = thinnestNear(joining.shells, pieces[i].outline);
    }
    std::vector<BodyOutline>& raw = joining.rawNext;
    raw = outlines;
    readBeyond(port, read, bodies, joining.found, raw, pieces, joining.farther);
    markChanged(frame, joining, raw, pieces);
    const std::vector<contact::Joined>& joined = joining.joiner.join(pieces, frame);
    std::size_t k = 0;
    for (BodyOutline& o : outlines) {
        while (before(raw[k], o))
            ++k;
        if (!joined[k].moved && joined[k].seams.empty())
            continue;
        if (!joining.spare.empty()) {
            o.local.seams = std::move(joining.spare.back());
            joining.spare.pop_back();
        }
        toBody(*stateOf(o.body, bodies), o.local, joined[k]);
    }
    joining.raw.swap(raw);
    joining.pieces.swap(pieces);
    joining.frame = frame;
}

void clearJoined(OutlineJoining& joining, std::vector<BodyOutline>& outlines) {
    joining.spare.clear();
    for (auto o = outlines.rbegin(); o != outlines.rend(); ++o)
        if (!o->local.seams.empty())
            joining.spare.push_back(std::move(o->local.seams));
    outlines.clear();
}

bool sameButSeams(const BodyOutline& a, const BodyOutline& b, double joined) {
    const contact::Outline &x = a.local, &y = b.local;
    const auto near = [joined](const Vec2& p, const Vec2& q) { return p == q || (p - q).norm() <= joined; };
    return a.body == b.body && a.friction == b.friction && x.kind == y.kind &&
           std::equal(x.points.begin(), x.points.end(), y.points.begin(), y.points.end(), near) &&
           x.radius == y.radius && x.joinedStart == y.joinedStart && x.joinedEnd == y.joinedEnd &&
           x.neighbourStart == y.neighbourStart && x.neighbourEnd == y.neighbourEnd && x.body == y.body &&
           x.key == y.key && x.motion == y.motion && x.category == y.category && x.mask == y.mask && x.group == y.group;
}

} // namespace supercircle::step
