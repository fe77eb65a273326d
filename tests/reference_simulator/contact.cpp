// Derivatives. The gap of two curves is a minimum over the place t on the other one, D(x) = min |p - c(t)|, so its
// second derivative is that of the distance at fixed t less what the minimum gains by following: with r = p - c,
// A = c'.c' - r.c'', H = (1/d) v v' - (d/A) w w', v the derivative of r along the tangent and w that of dD/dt.

#include "tests/reference_simulator/contact.h"

#include <algorithm>
#include <cmath>

namespace supercircle::oracle {

namespace {

Vec2 node(const Eigen::VectorXd& x, int i) {
    return x.segment<2>(2 * i);
}

} // namespace

Contacts::Contacts(const std::vector<NodalRod>& rods, const std::vector<Obstacle>& obstacles, double friction,
                   const Effects& effects, const ContactSettings& settings)
    : rods_(rods), obstacles_(obstacles), friction_(friction), effects_(effects), settings_(settings),
      stiffness_(1.0 / (1.0 / settings.stiffness + effects.normalGive)),
      tangential_(1.0 / (1.0 / settings.tangential + effects.tangentialGive)),
      reach_(std::max(settings.onset, effects.adhesion > 0.0 ? effects.adhesionRange : 0.0)) {
    for (std::size_t r = 0; r < rods.size(); ++r) {
        const int edges = rods[r].edges();
        for (int k = 0; k <= edges * settings.perEdge; ++k) {
            Sample s;
            s.rod = int(r);
            const int edge = std::min(edges - 1, k / settings.perEdge);
            s.at = weightsAt(edges, edge, double(k - edge * settings.perEdge) / settings.perEdge);
            const bool tip = k == 0 || k == edges * settings.perEdge;
            s.length = rods[r].spacing() / settings.perEdge * (tip ? 0.5 : 1.0);
            samples_.push_back(s);
        }
    }
}

Vec2 Contacts::pointOf(const Sample& s, const Eigen::VectorXd& x) const {
    Vec2 p = Vec2::Zero();
    const int first = rods_[size_t(s.rod)].base() + s.at.first;
    for (int k = 0; k < 4; ++k)
        p += s.at.value[k] * node(x, first + k);
    return p;
}

void Contacts::start(const Sample& s, Touch& t) const {
    t.count = 4;
    for (int k = 0; k < 4; ++k) {
        t.node[k] = rods_[size_t(s.rod)].base() + s.at.first + k;
        t.weight[k] = s.at.value[k];
        t.bend[k] = 0.0;
    }
}

bool Contacts::touchObstacle(const Sample& s, std::size_t o, const Eigen::VectorXd& x, double head, Touch& t) const {
    const Obstacle& b = obstacles_[o];
    const Vec2 centre = b.point + Vec2(0.0, b.onHead ? head : 0.0);
    const Vec2 r = pointOf(s, x) - centre;
    const double half = 0.5 * rods_[size_t(s.rod)].specimen().thickness;
    if (b.cylinder) {
        t.distance = r.norm();
        t.normal = r / t.distance;
        t.gap = t.distance - b.radius - half;
    } else {
        t.distance = 1e30;
        t.normal = b.normal;
        t.gap = r.dot(b.normal) - half;
    }
    if (t.gap > reach_)
        return false;
    start(s, t);
    t.tangent = {-t.normal.y(), t.normal.x()};
    t.curve = t.slope = 0.0;
    t.partner = int(o);
    t.onHead = b.onHead;
    const double place = b.cylinder ? b.radius * std::atan2(r.x(), r.y()) : r.dot(t.tangent);
    t.patch = effects_.roughness == 0.0
                  ? 1.0
                  : 1.0 + effects_.roughness * std::sin(2.0 * M_PI * place / effects_.roughLength);
    return true;
}

bool Contacts::touchRod(const Sample& s, int other, const Eigen::VectorXd& x, Touch& t) const {
    const NodalRod& rod = rods_[size_t(other)];
    const Vec2 p = pointOf(s, x);
    const double thick = 0.5 * (rods_[size_t(s.rod)].specimen().thickness + rod.specimen().thickness);
    // Nearest node, then Newton along the curve.
    double best = 1e30;
    int at = 0;
    for (int i = 0; i < rod.nodes(); ++i) {
        const double d = (node(x, rod.base() + i) - p).squaredNorm();
        if (d < best) {
            best = d;
            at = i;
        }
    }
    if (std::sqrt(best) > thick + reach_ + rod.spacing())
        return false;
    double place = at; // in edges
    Weights w;
    Vec2 c, slope, bend;
    const auto look = [&] {
        const int edge = std::clamp(int(std::floor(place)), 0, rod.edges() - 1);
        w = weightsAt(rod.edges(), edge, place - edge);
        c = slope = bend = Vec2::Zero();
        for (int k = 0; k < 4; ++k) {
            const Vec2 q = node(x, rod.base() + w.first + k);
            c += w.value[k] * q;
            slope += w.slope[k] * q;
            bend += w.bend[k] * q;
        }
    };
    for (int i = 0; i < 30; ++i) {
        look();
        const Vec2 r = p - c;
        const double a = std::max(slope.squaredNorm() - r.dot(bend), 0.2 * slope.squaredNorm());
        const double next = std::clamp(place + std::clamp(r.dot(slope) / a, -0.7, 0.7), 0.0, double(rod.edges()));
        const bool done = std::abs(next - place) < 1e-12;
        place = next;
        if (done)
            break;
    }
    look();
    const Vec2 r = p - c;
    t.distance = r.norm();
    t.gap = t.distance - thick;
    if (t.gap > reach_ || t.distance < 1e-9)
        return false;
    start(s, t);
    t.normal = r / t.distance;
    t.tangent = {-t.normal.y(), t.normal.x()};
    const bool inside = place > 0.0 && place < rod.edges();
    t.curve = inside ? slope.squaredNorm() - r.dot(bend) : 0.0;
    t.slope = inside ? slope.dot(t.tangent) : 0.0;
    t.count = kMost;
    for (int k = 0; k < 4; ++k) {
        t.node[4 + k] = rod.base() + w.first + k;
        t.weight[4 + k] = -w.value[k];
        t.bend[4 + k] = w.slope[k];
    }
    t.partner = int(obstacles_.size()) + other;
    t.onHead = false;
    t.patch = 1.0;
    return true;
}

Contacts::Pressure Contacts::repulsion(double gap) const {
    const double d = settings_.onset;
    if (gap < -d)
        return {-stiffness_ * gap, -stiffness_};
    if (gap < d)
        return {stiffness_ * (d - gap) * (d - gap) / (4.0 * d), -stiffness_ * (d - gap) / (2.0 * d)};
    return {};
}

Contacts::Pressure Contacts::attraction(const Sample& s, double gap) const {
    const double q = gap / effects_.adhesionRange, f = 6.75 * effects_.adhesion * s.length;
    if (effects_.adhesion <= 0.0 || q <= 0.0 || q >= 1.0)
        return {};
    return {-f * q * (1.0 - q) * (1.0 - q), -f * (1.0 - q) * (1.0 - 3.0 * q) / effects_.adhesionRange};
}

double Contacts::slip(const Touch& t, const Eigen::VectorXd& x, const Eigen::VectorXd& old, double head,
                      double oldHead) const {
    Vec2 d = Vec2::Zero();
    for (int k = 0; k < t.count; ++k)
        d += t.weight[k] * (node(x, t.node[k]) - node(old, t.node[k]));
    if (t.onHead)
        d.y() -= head - oldHead;
    return d.dot(t.tangent);
}

Contacts::Friction Contacts::friction(const Sample& s, const Touch& t, double load, double along, double dt) const {
    Friction f;
    const double from = s.partner == t.partner ? s.spring : 0.0;
    const double trial = from + along;
    const Effects& e = effects_;
    double coefficient = friction_ * t.patch;
    if (e.wear != 0.0)
        coefficient *= 1.0 + e.wear * -std::expm1(-s.way / e.wearLength);
    const auto excess = [&](double slid) { // memory at the end of the step
        return (s.fresh + dt / e.healTime) / (1.0 + dt / e.healTime + slid / e.slipLength);
    };
    const auto limit = [&](double slid, double& bySlip) {
        const double v = slid / dt, u = v / e.rateSpeed;
        double factor = 1.0, slope = 0.0;
        if (e.rate != 0.0) {
            factor += e.rate * (e.rateLaw < 0.5 ? -std::expm1(-u) : e.rateLaw < 1.5 ? std::log1p(u) : u);
            slope += e.rate *
                     (e.rateLaw < 0.5   ? std::exp(-u)
                      : e.rateLaw < 1.5 ? 1.0 / (1.0 + u)
                                        : 1.0) /
                     (e.rateSpeed * dt);
        }
        if (e.staticRatio != 1.0) {
            const double w = excess(slid);
            factor *= 1.0 + (e.staticRatio - 1.0) * w;
            slope -= (e.staticRatio - 1.0) * w / (1.0 + dt / e.healTime + slid / e.slipLength) / e.slipLength;
        }
        bySlip = coefficient * slope;
        return coefficient * factor;
    };
    double mu = 0.0, byslip = 0.0, slid = 0.0;
    mu = limit(0.0, byslip);
    const double sign = trial > 0.0 ? 1.0 : -1.0;
    if (tangential_ * std::abs(trial) <= mu * load) {
        f.spring = trial;
        f.force = -tangential_ * trial;
        f.bySlip = -tangential_;
    } else { // the slip with which the spring is at the limit
        for (int i = 0; i < 20; ++i) {
            mu = limit(slid, byslip);
            const double next = std::max(0.0, slid + (std::abs(trial) - slid - mu * load / tangential_) /
                                                         std::max(0.1, 1.0 + byslip * load / tangential_));
            const bool done = std::abs(next - slid) < 1e-15;
            slid = next;
            if (done)
                break;
        }
        mu = limit(slid, byslip);
        const double give = 1.0 + byslip * load / tangential_;
        f.force = -sign * mu * load;
        f.byNormal = -sign * mu / std::max(0.1, give);
        f.bySlip = -byslip * load / std::max(0.1, give);
        f.spring = sign * mu * load / tangential_;
    }
    f.fresh = e.staticRatio != 1.0 ? excess(slid) : 1.0;
    f.way = s.way + slid;
    return f;
}

void Contacts::add(const Sample& s, const Touch& t, const Eigen::VectorXd& x, const Eigen::VectorXd& old, double head,
                   double oldHead, double dt, Eigen::VectorXd& residual, LinearSystem* tangent,
                   HeadForce& onHead) const {
    const Pressure push = repulsion(t.gap), pull = attraction(s, t.gap);
    const double load = push.value, total = push.value + pull.value, slope = push.slope + pull.slope;
    const Friction f = friction(s, t, load, slip(t, x, old, head, oldHead), dt);
    const Vec2 force = total * t.normal + f.force * t.tangent; // on the sample
    for (int k = 0; k < t.count; ++k)
        residual.segment<2>(2 * t.node[k]) -= t.weight[k] * force;
    if (t.onHead)
        onHead.value -= force.y();
    if (tangent == nullptr)
        return;
    const Vec2 alongNormal = slope * t.normal + f.byNormal * push.slope * t.tangent; // d force / d gap
    const Vec2 alongSlip = f.bySlip * t.tangent;
    const double flat = t.distance > 1e29 ? 0.0 : 1.0 / t.distance;
    const double follow = t.curve > 0.0 ? t.distance / t.curve : 0.0;
    const auto w = [&](int k) -> Vec2 { return -t.slope * flat * t.weight[k] * t.tangent - t.bend[k] * t.normal; };
    for (int j = 0; j < t.count; ++j) {
        const Vec2 wj = w(j);
        const Vec2 turn = flat * t.weight[j] * t.tangent + (t.curve > 0.0 ? t.slope / t.curve : 0.0) * wj;
        const Eigen::Matrix2d direct = alongNormal * (t.weight[j] * t.normal).transpose() +
                                       alongSlip * (t.weight[j] * t.tangent).transpose() -
                                       f.force * t.normal * turn.transpose();
        for (int k = 0; k < t.count; ++k) {
            Eigen::Matrix2d m =
                t.weight[k] * direct + total * flat * t.weight[k] * t.weight[j] * t.tangent * t.tangent.transpose();
            if (follow > 0.0)
                m -= total * follow * w(k) * wj.transpose();
            for (int a = 0; a < 2; ++a)
                for (int b = 0; b < 2; ++b)
                    tangent->add(2 * t.node[k] + a, 2 * t.node[j] + b, -m(a, b));
        }
    }
    if (t.onHead && onHead.column.size() > 0) {
        const Eigen::Matrix2d direct = alongNormal * t.normal.transpose() + alongSlip * t.tangent.transpose();
        const Vec2 byHead = -direct.col(1);
        for (int k = 0; k < t.count; ++k) {
            onHead.column.segment<2>(2 * t.node[k]) -= t.weight[k] * byHead;
            onHead.row.segment<2>(2 * t.node[k]) -= t.weight[k] * direct.row(1).transpose();
        }
        onHead.byHead -= byHead.y();
    }
}

template <class Visit>
void Contacts::each(const Eigen::VectorXd& x, double head, Visit&& visit) const {
    Touch t;
    for (std::size_t i = 0; i < samples_.size(); ++i) {
        const Sample& s = samples_[i];
        for (std::size_t o = 0; o < obstacles_.size(); ++o)
            if (touchObstacle(s, o, x, head, t))
                visit(i, t);
        for (std::size_t r = 0; r < rods_.size(); ++r)
            if (int(r) != s.rod && touchRod(s, int(r), x, t))
                visit(i, t);
    }
}

void Contacts::addForces(const Eigen::VectorXd& x, const Eigen::VectorXd& old, double head, double oldHead, double dt,
                         Eigen::VectorXd& residual, LinearSystem* tangent, HeadForce& onHead) const {
    each(x, head, [&](std::size_t i, const Touch& t) {
        add(samples_[i], t, x, old, head, oldHead, dt, residual, tangent, onHead);
    });
}

void Contacts::commit(const Eigen::VectorXd& x, const Eigen::VectorXd& old, double head, double oldHead, double dt) {
    std::vector<Sample> next = samples_;
    for (Sample& s : next) {
        s.spring = 0.0;
        s.partner = -1;
        if (effects_.staticRatio != 1.0)
            s.fresh = (s.fresh + dt / effects_.healTime) / (1.0 + dt / effects_.healTime);
    }
    each(x, head, [&](std::size_t i, const Touch& t) {
        const double load = repulsion(t.gap).value; // only the repulsion loads the friction
        if (load <= 0.0)
            return;
        const Friction f = friction(samples_[i], t, load, slip(t, x, old, head, oldHead), dt);
        next[i].spring = f.spring;
        next[i].fresh = f.fresh;
        next[i].way = f.way;
        next[i].partner = t.partner;
    });
    samples_ = std::move(next);
}

void Contacts::rest() {
    for (Sample& s : samples_) {
        s.fresh = 1.0;
        s.way = 0.0;
    }
}

} // namespace supercircle::oracle
