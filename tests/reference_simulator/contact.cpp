// Derivatives of the gap of two curves. The gap is the minimum D(x) = min |p - c(t)| over the parameter t of the other
// curve. Its second derivative is that at fixed t, minus the gain of the minimum from following. With r = p - c and
// A = c'.c' - r.c'' it is H = (1/d) v v' - (d/A) w w'. Here v is the derivative of r along the tangent, w that of
// dD/dt.

#include "tests/reference_simulator/contact.h"

#include <algorithm>
#include <cmath>

namespace supercircle::reference_simulator {

namespace {

Vec2 nodeOf(const Eigen::VectorXd& x, int i) {
    return x.segment<2>(2 * i);
}

} // namespace

Contacts::Contacts(const std::vector<NodalRod>& rods, const std::vector<Obstacle>& obstacles, double friction,
                   const Effects& effects, const ContactSettings& settings)
    : rods_(rods), obstacles_(obstacles), friction_(friction), effects_(effects), settings_(settings),
      stiffness_(1.0 / (1.0 / settings.stiffness + effects.normalCompliance)),
      tangential_(1.0 / (1.0 / settings.tangential + effects.tangentialCompliance)),
      reach_(std::max(settings.onset, effects.adhesion > 0.0 ? effects.adhesionRange : 0.0)) {
    for (std::size_t r = 0; r < rods.size(); ++r) {
        const int edges = rods[r].edges();
        for (int k = 0; k <= edges * settings.samplesPerEdge; ++k) {
            Sample s;
            s.rod = int(r);
            const int edge = std::min(edges - 1, k / settings.samplesPerEdge);
            s.at = weightsAt(edges, edge, double(k - edge * settings.samplesPerEdge) / settings.samplesPerEdge);
            const bool tip = k == 0 || k == edges * settings.samplesPerEdge;
            s.length = rods[r].spacing() / settings.samplesPerEdge * (tip ? 0.5 : 1.0);
            samples_.push_back(s);
        }
    }
}

Vec2 Contacts::pointOf(const Sample& s, const Eigen::VectorXd& x) const {
    Vec2 p = Vec2::Zero();
    const int first = rods_[size_t(s.rod)].base() + s.at.first;
    for (int k = 0; k < 4; ++k)
        p += s.at.value[k] * nodeOf(x, first + k);
    return p;
}

void Contacts::setSampleNodes(const Sample& s, ContactGeometry& t) const {
    t.count = 4;
    for (int k = 0; k < 4; ++k) {
        t.node[k] = rods_[size_t(s.rod)].base() + s.at.first + k;
        t.weight[k] = s.at.value[k];
        t.slopeWeight[k] = 0.0;
    }
}

bool Contacts::findObstacleContact(const Sample& s, std::size_t o, const Eigen::VectorXd& x, double crosshead,
                                   ContactGeometry& t) const {
    const Obstacle& b = obstacles_[o];
    const Vec2 centre = b.point + Vec2(0.0, b.onCrosshead ? crosshead : 0.0);
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
    setSampleNodes(s, t);
    t.tangent = {-t.normal.y(), t.normal.x()};
    t.curvatureTerm = t.slope = 0.0;
    t.partner = int(o);
    t.onCrosshead = b.onCrosshead;
    const double alongSurface = b.cylinder ? b.radius * std::atan2(r.x(), r.y()) : r.dot(t.tangent);
    t.frictionFactor =
        effects_.frictionVariation == 0.0
            ? 1.0
            : 1.0 + effects_.frictionVariation * std::sin(2.0 * M_PI * alongSurface / effects_.frictionWavelength);
    return true;
}

bool Contacts::findRodContact(const Sample& s, int other, const Eigen::VectorXd& x, ContactGeometry& t) const {
    const NodalRod& rod = rods_[size_t(other)];
    const Vec2 p = pointOf(s, x);
    const double thick = 0.5 * (rods_[size_t(s.rod)].specimen().thickness + rod.specimen().thickness);
    // Nearest node, then Newton along the curve.
    double best = 1e30;
    int at = 0;
    for (int i = 0; i < rod.nodes(); ++i) {
        const double d = (nodeOf(x, rod.base() + i) - p).squaredNorm();
        if (d < best) {
            best = d;
            at = i;
        }
    }
    if (std::sqrt(best) > thick + reach_ + rod.spacing())
        return false;
    double arcPosition = at; // in edges
    Weights w;
    Vec2 c, slope, bend;
    const auto look = [&] {
        const int edge = std::clamp(int(std::floor(arcPosition)), 0, rod.edges() - 1);
        w = weightsAt(rod.edges(), edge, arcPosition - edge);
        c = slope = bend = Vec2::Zero();
        for (int k = 0; k < 4; ++k) {
            const Vec2 q = nodeOf(x, rod.base() + w.first + k);
            c += w.value[k] * q;
            slope += w.slope[k] * q;
            bend += w.bend[k] * q;
        }
    };
    for (int i = 0; i < 30; ++i) {
        look();
        const Vec2 r = p - c;
        const double a = std::max(slope.squaredNorm() - r.dot(bend), 0.2 * slope.squaredNorm());
        const double next = std::clamp(arcPosition + std::clamp(r.dot(slope) / a, -0.7, 0.7), 0.0, double(rod.edges()));
        const bool done = std::abs(next - arcPosition) < 1e-12;
        arcPosition = next;
        if (done)
            break;
    }
    look();
    const Vec2 r = p - c;
    t.distance = r.norm();
    t.gap = t.distance - thick;
    if (t.gap > reach_ || t.distance < 1e-9)
        return false;
    setSampleNodes(s, t);
    t.normal = r / t.distance;
    t.tangent = {-t.normal.y(), t.normal.x()};
    const bool inside = arcPosition > 0.0 && arcPosition < rod.edges();
    t.curvatureTerm = inside ? slope.squaredNorm() - r.dot(bend) : 0.0;
    t.slope = inside ? slope.dot(t.tangent) : 0.0;
    t.count = kMaxNodes;
    for (int k = 0; k < 4; ++k) {
        t.node[4 + k] = rod.base() + w.first + k;
        t.weight[4 + k] = -w.value[k];
        t.slopeWeight[4 + k] = w.slope[k];
    }
    t.partner = int(obstacles_.size()) + other;
    t.onCrosshead = false;
    t.frictionFactor = 1.0;
    return true;
}

Contacts::NormalForce Contacts::repulsion(double gap) const {
    const double d = settings_.onset;
    if (gap < -d)
        return {-stiffness_ * gap, -stiffness_};
    if (gap < d)
        return {stiffness_ * (d - gap) * (d - gap) / (4.0 * d), -stiffness_ * (d - gap) / (2.0 * d)};
    return {};
}

Contacts::NormalForce Contacts::adhesion(const Sample& s, double gap) const {
    const double q = gap / effects_.adhesionRange, f = 6.75 * effects_.adhesion * s.length;
    if (effects_.adhesion <= 0.0 || q <= 0.0 || q >= 1.0)
        return {};
    return {-f * q * (1.0 - q) * (1.0 - q), -f * (1.0 - q) * (1.0 - 3.0 * q) / effects_.adhesionRange};
}

double Contacts::slip(const ContactGeometry& t, const Eigen::VectorXd& x, const Eigen::VectorXd& old, double crosshead,
                      double oldCrosshead) const {
    Vec2 d = Vec2::Zero();
    for (int k = 0; k < t.count; ++k)
        d += t.weight[k] * (nodeOf(x, t.node[k]) - nodeOf(old, t.node[k]));
    if (t.onCrosshead)
        d.y() -= crosshead - oldCrosshead;
    return d.dot(t.tangent);
}

Contacts::Friction Contacts::friction(const Sample& s, const ContactGeometry& t, double load, double along,
                                      double dt) const {
    Friction f;
    const double from = s.partner == t.partner ? s.elongation : 0.0;
    const double trial = from + along;
    const Effects& e = effects_;
    double coefficient = friction_ * t.frictionFactor;
    if (e.wear != 0.0)
        coefficient *= 1.0 + e.wear * -std::expm1(-s.slidDistance / e.wearLength);
    const auto excess = [&](double slid) { // ageing at the end of the step
        return (s.ageing + dt / e.healTime) / (1.0 + dt / e.healTime + slid / e.slipLength);
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
        f.elongation = trial;
        f.force = -tangential_ * trial;
        f.bySlip = -tangential_;
    } else { // slip at which the spring is at the limit
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
        const double derivative = 1.0 + byslip * load / tangential_;
        f.force = -sign * mu * load;
        f.byNormal = -sign * mu / std::max(0.1, derivative);
        f.bySlip = -byslip * load / std::max(0.1, derivative);
        f.elongation = sign * mu * load / tangential_;
    }
    f.ageing = e.staticRatio != 1.0 ? excess(slid) : 1.0;
    f.slidDistance = s.slidDistance + slid;
    return f;
}

void Contacts::add(const Sample& s, const ContactGeometry& t, const Eigen::VectorXd& x, const Eigen::VectorXd& old,
                   double crosshead, double oldCrosshead, double dt, Eigen::VectorXd& residual, LinearSystem* tangent,
                   CrossheadForce& onCrosshead) const {
    const NormalForce push = repulsion(t.gap), pull = adhesion(s, t.gap);
    const double load = push.value, total = push.value + pull.value, slope = push.slope + pull.slope;
    const Friction f = friction(s, t, load, slip(t, x, old, crosshead, oldCrosshead), dt);
    const Vec2 force = total * t.normal + f.force * t.tangent; // on the sample
    for (int k = 0; k < t.count; ++k)
        residual.segment<2>(2 * t.node[k]) -= t.weight[k] * force;
    if (t.onCrosshead)
        onCrosshead.value -= force.y();
    if (tangent == nullptr)
        return;
    const Vec2 alongNormal = slope * t.normal + f.byNormal * push.slope * t.tangent; // d force / d gap
    const Vec2 alongSlip = f.bySlip * t.tangent;
    const double flat = t.distance > 1e29 ? 0.0 : 1.0 / t.distance;
    const double follow = t.curvatureTerm > 0.0 ? t.distance / t.curvatureTerm : 0.0;
    const auto w = [&](int k) -> Vec2 {
        return -t.slope * flat * t.weight[k] * t.tangent - t.slopeWeight[k] * t.normal;
    };
    for (int j = 0; j < t.count; ++j) {
        const Vec2 wj = w(j);
        const Vec2 turn =
            flat * t.weight[j] * t.tangent + (t.curvatureTerm > 0.0 ? t.slope / t.curvatureTerm : 0.0) * wj;
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
    if (t.onCrosshead && onCrosshead.column.size() > 0) {
        const Eigen::Matrix2d direct = alongNormal * t.normal.transpose() + alongSlip * t.tangent.transpose();
        const Vec2 byCrosshead = -direct.col(1);
        for (int k = 0; k < t.count; ++k) {
            onCrosshead.column.segment<2>(2 * t.node[k]) -= t.weight[k] * byCrosshead;
            onCrosshead.row.segment<2>(2 * t.node[k]) -= t.weight[k] * direct.row(1).transpose();
        }
        onCrosshead.byCrosshead -= byCrosshead.y();
    }
}

template <class Visit>
void Contacts::forEachContact(const Eigen::VectorXd& x, double crosshead, Visit&& visit) const {
    ContactGeometry t;
    for (std::size_t i = 0; i < samples_.size(); ++i) {
        const Sample& s = samples_[i];
        for (std::size_t o = 0; o < obstacles_.size(); ++o)
            if (findObstacleContact(s, o, x, crosshead, t))
                visit(i, t);
        for (std::size_t r = 0; r < rods_.size(); ++r)
            if (int(r) != s.rod && findRodContact(s, int(r), x, t))
                visit(i, t);
    }
}

void Contacts::addForces(const Eigen::VectorXd& x, const Eigen::VectorXd& old, double crosshead, double oldCrosshead,
                         double dt, Eigen::VectorXd& residual, LinearSystem* tangent,
                         CrossheadForce& onCrosshead) const {
    forEachContact(x, crosshead, [&](std::size_t i, const ContactGeometry& t) {
        add(samples_[i], t, x, old, crosshead, oldCrosshead, dt, residual, tangent, onCrosshead);
    });
}

void Contacts::commit(const Eigen::VectorXd& x, const Eigen::VectorXd& old, double crosshead, double oldCrosshead,
                      double dt) {
    std::vector<Sample> next = samples_;
    for (Sample& s : next) {
        s.elongation = 0.0;
        s.partner = -1;
        if (effects_.staticRatio != 1.0)
            s.ageing = (s.ageing + dt / effects_.healTime) / (1.0 + dt / effects_.healTime);
    }
    forEachContact(x, crosshead, [&](std::size_t i, const ContactGeometry& t) {
        const double load = repulsion(t.gap).value; // adhesion does not load the friction
        if (load <= 0.0)
            return;
        const Friction f = friction(samples_[i], t, load, slip(t, x, old, crosshead, oldCrosshead), dt);
        next[i].elongation = f.elongation;
        next[i].ageing = f.ageing;
        next[i].slidDistance = f.slidDistance;
        next[i].partner = t.partner;
    });
    samples_ = std::move(next);
}

void Contacts::resetHistory() {
    for (Sample& s : samples_) {
        s.ageing = 1.0;
        s.slidDistance = 0.0;
    }
}

} // namespace supercircle::reference_simulator
