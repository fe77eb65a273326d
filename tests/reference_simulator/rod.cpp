#include "tests/reference_simulator/rod.h"

#include <algorithm>
#include <cmath>

namespace supercircle::reference_simulator {

namespace {

Vec2 perp(const Vec2& a) {
    return {-a.y(), a.x()};
}

double wrap(double angle) {
    return std::remainder(angle, 2.0 * M_PI);
}

double angle(const Vec2& e) {
    return std::atan2(e.y(), e.x());
}

/// Second derivative of the angle of an edge.
Eigen::Matrix2d bendOfAngle(const Vec2& e) {
    const double a = e.x(), b = e.y(), r4 = e.squaredNorm() * e.squaredNorm();
    Eigen::Matrix2d h;
    h << 2.0 * a * b, b * b - a * a, b * b - a * a, -2.0 * a * b;
    return h / r4;
}

Vec2 node(const Eigen::VectorXd& x, int i) {
    return x.segment<2>(2 * i);
}

void addBlock(LinearSystem& k, int i, int j, const Eigen::Matrix2d& m) {
    for (int a = 0; a < 2; ++a)
        for (int b = 0; b < 2; ++b)
            k.add(2 * i + a, 2 * j + b, m(a, b));
}

} // namespace

Weights weightsAt(int edges, int edge, double t) {
    const double t2 = t * t, t3 = t2 * t;
    const Eigen::Vector4d v(0.5 * (-t + 2 * t2 - t3), 0.5 * (2 - 5 * t2 + 3 * t3), 0.5 * (t + 4 * t2 - 3 * t3),
                            0.5 * (-t2 + t3));
    const Eigen::Vector4d s(0.5 * (-1 + 4 * t - 3 * t2), 0.5 * (-10 * t + 9 * t2), 0.5 * (1 + 8 * t - 9 * t2),
                            0.5 * (-2 * t + 3 * t2));
    const Eigen::Vector4d b(0.5 * (4 - 6 * t), 0.5 * (-10 + 18 * t), 0.5 * (8 - 18 * t), 0.5 * (-2 + 6 * t));
    Weights w;
    w.first = std::clamp(edge - 1, 0, edges - 3);
    // A node beyond an end continues the last three with the same second difference.
    const auto fold = [&](const Eigen::Vector4d& from, Eigen::Vector4d& to) {
        for (int k = 0; k < 4; ++k) {
            const int at = edge - 1 + k - w.first;
            if (at < 0) {
                to[0] += 3.0 * from[k];
                to[1] -= 3.0 * from[k];
                to[2] += from[k];
            } else if (at > 3) {
                to[3] += 3.0 * from[k];
                to[2] -= 3.0 * from[k];
                to[1] += from[k];
            } else {
                to[at] += from[k];
            }
        }
    };
    fold(v, w.value);
    fold(s, w.slope);
    fold(b, w.bend);
    return w;
}

NodalRod::NodalRod(const Specimen& specimen, const Effects& effects, int index, int base, int edges)
    : specimen_(specimen), effects_(effects), base_(base), edges_(edges), ds_(specimen.length / edges) {
    if (effects.specimen >= 0.0 && index != int(effects.specimen)) {
        const Effects none;
        for (double Effects::*m : {&Effects::damage, &Effects::damageCurvature, &Effects::defect, &Effects::gradient})
            effects_.*m = none.*m;
    }
    const int held = specimen.clamp == ClampAt::None ? -1 : specimen.clamp == ClampAt::FirstEnd ? 0 : edges / 2;
    clamped_ = held < 0 ? -1 : base + held;
    for (int i = 0; i <= edges; ++i) {
        if (i == held) {
            if (i > 0)
                addHinge(i - 1, i, -1, 0.5 * ds_, (i - 0.25) / edges);
            addHinge(-1, i, i + 1, 0.5 * ds_, (i + 0.25) / edges);
        } else if (i > 0 && i < edges) {
            addHinge(i - 1, i, i + 1, ds_, double(i) / edges);
        }
    }
    std::vector<double> natural(size_t(edges), specimen.curvature);
    for (const Hinge& j : hinges_) { // an edge is bent like the hinges at its ends
        if (j.left >= 0)
            natural[size_t(j.middle - base_ - 1)] += 0.5 * (j.natural - specimen.curvature);
        if (j.right >= 0)
            natural[size_t(j.middle - base_)] += 0.5 * (j.natural - specimen.curvature);
    }
    for (const double k : natural) // chord of the arc
        rest_.push_back(std::abs(k * ds_) < 1e-6 ? ds_ : 2.0 / k * std::sin(0.5 * k * ds_));
}

void NodalRod::addHinge(int left, int middle, int right, double length, double place) {
    Hinge j;
    j.left = left < 0 ? -1 : base_ + left;
    j.middle = base_ + middle;
    j.right = right < 0 ? -1 : base_ + right;
    j.length = length;
    j.place = place;
    const Effects& e = effects_;
    const double from = (place - e.damageArcFraction) * specimen_.length / e.damageStandardDeviation;
    const double weight = std::exp(-0.5 * from * from);
    const double slope = 1.0 + e.gradient * (2.0 * place - 1.0);
    j.modulus = specimen_.modulus * (1.0 - e.damage * weight) * (e.gradientLaw > 0.5 ? slope : slope * slope * slope);
    // Share of the hinge's length inside the defect.
    const double a = place * specimen_.length - 0.5 * length, b = a + length;
    const double lo = e.defectArcFraction * specimen_.length - 0.5 * e.defectLength, hi = lo + e.defectLength;
    const double share = std::clamp((std::min(b, hi) - std::max(a, lo)) / length, 0.0, 1.0);
    j.natural = specimen_.curvature + e.damageCurvature * weight + e.defect * share;
    hinges_.push_back(j);
}

std::vector<Vec2> NodalRod::naturalShape() const {
    std::vector<Vec2> out(size_t(nodes()), Vec2::Zero());
    std::vector<double> turn(size_t(nodes()), 0.0), half(size_t(nodes()), 0.0);
    for (const Hinge& j : hinges_) {
        turn[size_t(j.middle - base_)] += j.natural * j.length;
        half[size_t(j.middle - base_)] = j.natural * 0.5 * ds_;
    }
    const int start = clamped_ >= 0 ? clamped_ - base_ : edges_ / 2;
    const double tangent = clamped_ >= 0 ? specimen_.angle : M_PI;
    out[size_t(start)] = clamped_ >= 0 ? specimen_.point : Vec2::Zero();
    double a = tangent + half[size_t(start)];
    for (int i = start; i < edges_; ++i) {
        if (i > start)
            a += turn[size_t(i)];
        out[size_t(i + 1)] = out[size_t(i)] + rest_[size_t(i)] * Vec2(std::cos(a), std::sin(a));
    }
    a = tangent - half[size_t(start)];
    for (int i = start; i > 0; --i) {
        if (i < start)
            a -= turn[size_t(i)];
        out[size_t(i - 1)] = out[size_t(i)] - rest_[size_t(i - 1)] * Vec2(std::cos(a), std::sin(a));
    }
    return out;
}

double NodalRod::angleOf(const Hinge& j, const Eigen::VectorXd& x) const {
    const double before = j.left < 0 ? specimen_.angle : angle(node(x, j.middle) - node(x, j.left));
    const double after = j.right < 0 ? specimen_.angle : angle(node(x, j.right) - node(x, j.middle));
    return wrap(after - before);
}

NodalRod::Moment NodalRod::moment(const Hinge& j, double curvature, double t, double dt) const {
    const Effects& e = effects_;
    double b = j.modulus;
    if (e.softening > 0.0)
        b *= e.softeningIsLogarithmic > 0.5 ? 1.0 - e.softening * std::log10(1.0 + std::max(0.0, t) / e.softeningTime)
                                            : 1.0 - e.softening * (1.0 - std::exp(-std::max(0.0, t) / e.softeningTime));
    Moment m;
    m.plastic = j.plastic;
    m.accumulated = j.accumulated;
    const double u = curvature - j.natural;
    if (e.yield > 0.0) {
        const bool moves = e.kinematic > 0.5;
        const double back = moves ? e.hardening * j.plastic : 0.0;
        const double trial = u - j.plastic, over = trial - back;
        const double range = e.yield + (moves ? 0.0 : e.hardening * j.accumulated);
        m.value = b * trial;
        m.slope = b;
        if (std::abs(over) > range) {
            const double flow = (std::abs(over) - range) / (1.0 + e.hardening);
            m.plastic += over > 0.0 ? flow : -flow;
            m.accumulated += flow;
            m.value = b * (u - m.plastic);
            m.slope = b * e.hardening / (1.0 + e.hardening);
        }
    } else if (e.softeningCurvature > 0.0) {
        const double s = 1.0 + u * u / (e.softeningCurvature * e.softeningCurvature);
        m.value = b * u / std::sqrt(s);
        m.slope = b / (s * std::sqrt(s));
    } else if (e.stiffeningCurvature > 0.0) {
        const double q = u * u / (e.stiffeningCurvature * e.stiffeningCurvature);
        m.value = b * u * (1.0 + q);
        m.slope = b * (1.0 + 3.0 * q);
    } else {
        m.value = b * u;
        m.slope = b;
    }
    if (dt > 0.0 && e.kelvinVoigtTime > 0.0) {
        m.value += b * e.kelvinVoigtTime * (curvature - j.curvature) / dt;
        m.slope += b * e.kelvinVoigtTime / dt;
    }
    if (dt > 0.0 && e.branch > 0.0) {
        const double age = dt / e.branchTime, held = e.branch * b * -std::expm1(-age) / age;
        m.branch = std::exp(-age) * j.branchMoment + held * (curvature - j.curvature);
        m.value += m.branch;
        m.slope += held;
    }
    return m;
}

void NodalRod::addBending(const Hinge& j, const Eigen::VectorXd& x, double t, double dt, Eigen::VectorXd& gradient,
                          LinearSystem* tangent) const {
    const Moment m = moment(j, angleOf(j, x) / j.length, t, dt);
    int nodes[3] = {j.left, j.middle, j.right};
    Vec2 d[3] = {Vec2::Zero(), Vec2::Zero(), Vec2::Zero()};
    Eigen::Matrix2d before = Eigen::Matrix2d::Zero(), after = Eigen::Matrix2d::Zero();
    if (j.left >= 0) {
        const Vec2 e = node(x, j.middle) - node(x, j.left), g = perp(e) / e.squaredNorm();
        d[0] += g;
        d[1] -= g;
        before = -m.value * bendOfAngle(e);
    }
    if (j.right >= 0) {
        const Vec2 e = node(x, j.right) - node(x, j.middle), g = perp(e) / e.squaredNorm();
        d[1] -= g;
        d[2] += g;
        after = m.value * bendOfAngle(e);
    }
    for (int a = 0; a < 3; ++a)
        if (nodes[a] >= 0)
            gradient.segment<2>(2 * nodes[a]) += m.value * d[a];
    if (tangent == nullptr)
        return;
    for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) {
            if (nodes[a] < 0 || nodes[b] < 0)
                continue;
            Eigen::Matrix2d h = (m.slope / j.length) * d[a] * d[b].transpose();
            if (a < 2 && b < 2)
                h += (a == b ? 1.0 : -1.0) * before;
            if (a > 0 && b > 0)
                h += (a == b ? 1.0 : -1.0) * after;
            addBlock(*tangent, nodes[a], nodes[b], h);
        }
}

void NodalRod::addStretching(int edge, const Eigen::VectorXd& x, Eigen::VectorXd& gradient,
                             LinearSystem* tangent) const {
    const int i = base_ + edge, k = i + 1;
    const Vec2 e = node(x, k) - node(x, i);
    const double l0 = rest_[size_t(edge)], l = e.norm(), tension = specimen_.stretchModulus * (l / l0 - 1.0);
    const Vec2 n = e / l;
    gradient.segment<2>(2 * k) += tension * n;
    gradient.segment<2>(2 * i) -= tension * n;
    if (tangent == nullptr)
        return;
    const Eigen::Matrix2d h = specimen_.stretchModulus / l0 * n * n.transpose() +
                              tension / l * (Eigen::Matrix2d::Identity() - n * n.transpose());
    addBlock(*tangent, i, i, h);
    addBlock(*tangent, k, k, h);
    addBlock(*tangent, i, k, -h);
    addBlock(*tangent, k, i, -h);
}

void NodalRod::addForces(const Eigen::VectorXd& x, double t, double dt, Eigen::VectorXd& gradient,
                         LinearSystem* tangent) const {
    for (const Hinge& j : hinges_)
        addBending(j, x, t, dt, gradient, tangent);
    for (int i = 0; i < edges_; ++i)
        addStretching(i, x, gradient, tangent);
}

void NodalRod::commit(const Eigen::VectorXd& x, double t, double dt) {
    for (Hinge& j : hinges_) {
        const double k = angleOf(j, x) / j.length;
        const Moment m = moment(j, k, t, dt);
        j.curvature = k;
        j.branchMoment = m.branch;
        j.plastic = m.plastic;
        j.accumulated = m.accumulated;
    }
}

void NodalRod::resetHistory(const Eigen::VectorXd& x) {
    for (Hinge& j : hinges_) {
        j.curvature = angleOf(j, x) / j.length;
        j.branchMoment = j.plastic = j.accumulated = 0.0;
    }
}

double NodalRod::elasticEnergy(const Eigen::VectorXd& x) const {
    double sum = 0.0;
    for (const Hinge& j : hinges_) {
        const double u = angleOf(j, x) / j.length - j.natural;
        sum += 0.5 * j.modulus * u * u * j.length;
    }
    for (int i = 0; i < edges_; ++i) {
        const double l0 = rest_[size_t(i)], l = (node(x, base_ + i + 1) - node(x, base_ + i)).norm();
        sum += 0.5 * specimen_.stretchModulus * l0 * (l / l0 - 1.0) * (l / l0 - 1.0);
    }
    return sum;
}

double NodalRod::maxCurvatureChange(const Eigen::VectorXd& x) const {
    double most = 0.0;
    for (const Hinge& j : hinges_)
        most = std::max(most, std::abs(angleOf(j, x) / j.length - j.natural));
    return most;
}

} // namespace supercircle::reference_simulator
