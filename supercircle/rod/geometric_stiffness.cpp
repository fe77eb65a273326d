#include "supercircle/rod/geometric_stiffness.h"

#include "supercircle/support/trig.h"

#include <cmath>

namespace supercircle::rod {

namespace {

void addSymmetric(Eigen::MatrixXd& K, int i, int j, double value) {
    K(i, j) += value;
    K(j, i) += value;
}

/// Adds the couplings of segment k's curvature with theta and with every curvature further in, given
/// `turned` = f . perp(dr/dk).
void addInnerCouplings(const RodModel& model, int side, int k, double turned, Eigen::MatrixXd& K) {
    const auto& list = model.side(side);
    const int d = list[static_cast<std::size_t>(k)].dof;
    addSymmetric(K, d, model.dofTheta(), -turned);
    for (int j = 0; j < k; ++j) {
        const Segment& inner = list[static_cast<std::size_t>(j)];
        addSymmetric(K, d, inner.dof, -inner.signedLength * turned);
    }
}

} // namespace

Vec2 chordSecondDerivative(const Arc& arc, double s) {
    // chord = s sinc(x) t(x) with x = k s/2, hence chord'' = s^3/4 [(sinc'' - sinc) t + 2 sinc' n], and
    // sinc'' = -sinc - 2 sinc'/x needs no series of its own: sinc' has full relative accuracy.
    const double x = 0.5 * arc.curvature * s;
    const double slope = sincDerivative(x);
    const double ratio = std::abs(x) < 1e-8 ? -1.0 / 3.0 : slope / x;
    const Vec2 t = arc.tangentAt(0.5 * s);
    return (0.5 * s * s * s) * (slope * perp(t) - (math::sinc(x) + ratio) * t);
}

void addPointForceStiffness(const RodModel& model, const Kinematics& kin, const MaterialPoint& at, const Vec2& offset,
                            const Vec2& f, Eigen::MatrixXd& K) {
    const auto& list = model.side(at.side);
    const Arc& own = kin.segmentArc(at.side, at.segment);
    const Vec2 p = own.pointAt(at.local) + offset;
    K(model.dofTheta(), model.dofTheta()) += f.dot(p - kin.middle());
    for (int k = 0; k < at.segment; ++k) {
        const Segment& seg = list[static_cast<std::size_t>(k)];
        const double l = seg.signedLength;
        const Arc& arc = kin.segmentArc(at.side, k);
        // perp(dp/dk) = perp(l perp(p - c)) = -l (p - c)
        addInnerCouplings(model, at.side, k, -l * f.dot(p - kin.centroid(at.side, k)), K);
        K(seg.dof, seg.dof) -= f.dot(chordSecondDerivative(arc, l) - l * l * (p - arc.pointAt(l)));
    }
    const int d = list[static_cast<std::size_t>(at.segment)].dof;
    const Vec2 e = own.chordCurvatureDerivative(at.local) + at.local * perp(offset);
    addInnerCouplings(model, at.side, at.segment, f.dot(perp(e)), K);
    K(d, d) -= f.dot(chordSecondDerivative(own, at.local) - at.local * at.local * offset);
}

void addUniformStiffness(const RodModel& model, const Kinematics& kin, const GaussField& field, const Vec2& a,
                         Eigen::MatrixXd& K) {
    const double lambda = model.definition().linearMass;
    std::size_t g = 0;
    double spin = 0.0;
    for (int side = 0; side < 2; ++side) {
        const auto& list = model.side(side);
        // Mass and first moment of everything beyond each segment; one uniform arc's centre of mass is its centroid.
        double mass = 0.0;
        Vec2 first = Vec2::Zero();
        const std::size_t base = g;
        g += RodModel::kGauss * list.size();
        for (int k = static_cast<int>(list.size()) - 1; k >= 0; --k) {
            const Segment& seg = list[static_cast<std::size_t>(k)];
            const Arc& arc = kin.segmentArc(side, k);
            const double l = seg.signedLength;
            const Vec2 c = kin.centroid(side, k) - kin.middle();
            Vec2 e = Vec2::Zero();  // sum of m dr/dk over the segment itself
            Vec2 ee = Vec2::Zero(); // sum of m d2r/dk2
            for (int i = 0; i < RodModel::kGauss; ++i) {
                const std::size_t h = base + static_cast<std::size_t>(RodModel::kGauss * k + i);
                e += field.mass[h] * field.own[h];
                ee += field.mass[h] * chordSecondDerivative(arc, l * RodModel::kGaussNode[i]);
            }
            const auto [begin, stop] = model.carriedOn(side, static_cast<std::size_t>(k));
            for (std::size_t i = begin; i < stop; ++i) {
                const CarriedPoint& p = model.carried()[i];
                const std::size_t h = static_cast<std::size_t>(model.gaussPoints()) + i;
                e += field.mass[h] * field.own[h];
                ee += field.mass[h] *
                      (chordSecondDerivative(arc, p.local) - p.local * p.local * p.ahead * arc.tangentAt(p.local));
            }
            const Vec2 end = arc.pointAt(l) - kin.middle();
            addInnerCouplings(model, side, k, a.dot(perp(e) - l * (first - mass * c)), K);
            K(seg.dof, seg.dof) -= a.dot(ee + mass * chordSecondDerivative(arc, l) - l * l * (first - mass * end));
            const double m = lambda * std::abs(l);
            first += m * c;
            mass += m;
            for (std::size_t i = begin; i < stop; ++i) {
                const std::size_t h = static_cast<std::size_t>(model.gaussPoints()) + i;
                first += field.mass[h] * field.arm[h];
                mass += field.mass[h];
            }
        }
        spin += a.dot(first);
    }
    K(model.dofTheta(), model.dofTheta()) += spin;
}

} // namespace supercircle::rod
