#include "supercircle/rod/inertia.h"

#include "supercircle/rod/geometric_stiffness.h"

#include <algorithm>
#include <cmath>

namespace supercircle::rod {

namespace {

/// The vector unit handles nodes in pairs, so one unused node is added.
constexpr int kPadded = RodModel::kGauss + 1;
constexpr double kNode[kPadded] = {RodModel::kGaussNode[0], RodModel::kGaussNode[1], RodModel::kGaussNode[2],
                                   RodModel::kGaussNode[3], RodModel::kGaussNode[4], 0.5};

/// Components along the tangent and normal at a segment's inner end, at its nodes.
struct NodeField {
    double along[kPadded], across[kPadded];       ///< of the vector from the inner end, m
    double ownAlong[kPadded], ownAcross[kPadded]; ///< of the derivative by the curvature of this segment, m^2
};

/// Of a segment of signed length `length` that turns by `turn`.
void fieldAtNodes(double length, double turn, NodeField& field) {
    double versine[kPadded], deficit[kPadded];
    const double z = turn * turn;
    if (std::abs(turn) < TurnFactors::kShortBelow) {
        for (int i = 0; i < kPadded; ++i) {
            const TurnFactors f = TurnFactors::shortSeries(z * (kNode[i] * kNode[i]));
            versine[i] = f.versine;
            deficit[i] = f.deficit;
        }
    } else {
        for (int i = 0; i < kPadded; ++i) {
            const TurnFactors f = TurnFactors::of(turn * kNode[i]);
            versine[i] = f.versine;
            deficit[i] = f.deficit;
        }
    }
    for (int i = 0; i < kPadded; ++i) {
        const double s = length * kNode[i];
        const double x = turn * kNode[i];
        const double sine = 1.0 - x * x * deficit[i]; // over x
        field.along[i] = s * sine;
        field.across[i] = s * x * versine[i];
        field.ownAlong[i] = s * s * (x * (deficit[i] - versine[i]));
        field.ownAcross[i] = s * s * (sine - versine[i]);
    }
}

/// Second derivative by the curvature of the vector from a segment's inner end to its nodes, along tangent and normal
/// there, m^3.
void bendingOfField(double length, double turn, double* along, double* across) {
    for (int i = 0; i < RodModel::kGauss; ++i) {
        const double s = length * kNode[i], x = turn * kNode[i], z = x * x;
        const TurnFactors f = TurnFactors::of(x);
        constexpr double kSmall = 1e-2; // of z, where the difference loses two digits; the series is exact to 1e-16
        const double rest =
            z < kSmall ? 1.0 / 24.0 - z * (1.0 / 720.0 - z * (1.0 / 40320.0 - z / 3628800.0)) : (0.5 - f.versine) / z;
        along[i] = -s * s * s * (1.0 - z * f.deficit - 2.0 * (f.versine - f.deficit));
        across[i] = -s * s * s * x * (2.0 * rest + f.versine - 2.0 * f.deficit);
    }
}

/// Mass moments of everything beyond a section, about the rod's middle.
struct Moments {
    double mass = 0.0;
    Vec2 first = Vec2::Zero();
    double second = 0.0;
};

/// Sums over the Gauss points of one segment that involve its own curvature derivative e.
struct OwnSums {
    Vec2 e = Vec2::Zero();
    double turn = 0.0; ///< sum m (arm x e) = sum m perp(arm) . e
    double square = 0.0;
};

struct SegmentView {
    const Segment* seg;
    int base;      ///< first Gauss index
    Vec2 centroid; ///< relative to the middle
    std::size_t firstCarried, endCarried;
};

/// Visits the points at which the mass of a segment sits.
template <class Visit>
void forMass(const SegmentView& s, Visit&& visit) {
    const auto base = static_cast<std::size_t>(s.base);
    for (std::size_t i = 0; i < RodModel::kGauss; ++i)
        visit(base + i);
    for (std::size_t g = s.firstCarried; g < s.endCarried; ++g)
        visit(g);
}

SegmentView view(const RodModel& model, const Kinematics& kin, int side, int k) {
    const int offset = side == 0 ? 0 : static_cast<int>(model.side(0).size());
    const auto [first, end] = model.carriedOn(side, static_cast<std::size_t>(k));
    const auto before = static_cast<std::size_t>(model.gaussPoints());
    return {&model.side(side)[static_cast<std::size_t>(k)], RodModel::kGauss * (offset + k),
            kin.centroid(side, k) - kin.middle(), before + first, before + end};
}

} // namespace

void evaluateGauss(const RodModel& model, const Kinematics& kin, GaussField& field) {
    const auto n = static_cast<std::size_t>(model.massPoints());
    field.arm.resize(n);
    field.own.resize(n);
    field.mass.resize(n);
    std::size_t g = 0;
    for (int side = 0; side < 2; ++side)
        for (std::size_t k = 0; k < model.side(side).size(); ++k) {
            const Arc& arc = kin.segmentArc(side, static_cast<int>(k));
            const Vec2 inner = arc.start - kin.middle();
            const Vec2 t = kin.segmentTangent(side, static_cast<int>(k));
            const Vec2 normal = perp(t);
            const double m = model.definition().linearMass * std::abs(arc.length);
            NodeField nodes;
            fieldAtNodes(arc.length, arc.curvature * arc.length, nodes);
            for (int i = 0; i < RodModel::kGauss; ++i, ++g) {
                field.arm[g] = inner + nodes.along[i] * t + nodes.across[i] * normal;
                field.own[g] = nodes.ownAlong[i] * t + nodes.ownAcross[i] * normal;
                field.mass[g] = m * RodModel::kGaussWeight[i];
            }
        }
    for (const CarriedPoint& c : model.carried()) {
        const Arc& arc = kin.segmentArc(c.side, c.segment);
        const Vec2 ahead = c.ahead * arc.tangentAt(c.local);
        field.arm[g] = arc.pointAt(c.local) + ahead - kin.middle();
        field.own[g] = arc.chordCurvatureDerivative(c.local) + c.local * perp(ahead);
        field.mass[g++] = c.mass;
    }
}

void massMatrix(const RodModel& model, const Kinematics& kin, const GaussField& field, Eigen::MatrixXd& M) {
    const int n = model.dofs(), X = model.dofX(), Y = model.dofY(), T = model.dofTheta();
    M.setZero(n, n);
    Moments all;
    for (int side = 0; side < 2; ++side) {
        const int count = static_cast<int>(model.side(side).size());
        Moments beyond;
        for (int k = count - 1; k >= 0; --k) {
            const SegmentView v = view(model, kin, side, k);
            OwnSums own;
            Moments inside;
            forMass(v, [&](std::size_t g) {
                const double m = field.mass[g];
                own.e += m * field.own[g];
                own.turn += m * cross(field.arm[g], field.own[g]);
                own.square += m * field.own[g].squaredNorm();
                inside.mass += m;
                inside.first += m * field.arm[g];
                inside.second += m * field.arm[g].squaredNorm();
            });
            const double f = v.seg->signedLength;
            const int d = v.seg->dof;
            const Vec2 lever = beyond.first - beyond.mass * v.centroid;
            const Vec2 push = f * perp(lever) + own.e; // column of (x, y)
            // The column of a rotation about p further in: turn - (cross of p and push). p = middle gives theta.
            const double turn = f * (beyond.second - beyond.first.dot(v.centroid)) + own.turn;
            M(X, d) += push.x();
            M(Y, d) += push.y();
            M(T, d) += turn;
            M(d, d) += f * f * (beyond.second - v.centroid.dot(beyond.first + lever)) + own.square;
            double* column = M.data() + static_cast<Eigen::Index>(d) * n;
            const Segment* inner = model.side(side).data();
            for (int j = 0; j < k; ++j) {
                const int r = inner[j].dof;
                column[r] = inner[j].signedLength * (turn - cross(kin.centroid(side, j) - kin.middle(), push));
                M(d, r) = column[r];
            }
            beyond.mass += inside.mass;
            beyond.first += inside.first;
            beyond.second += inside.second;
        }
        all.mass += beyond.mass;
        all.first += beyond.first;
        all.second += beyond.second;
    }
    M(X, X) = M(Y, Y) = all.mass;
    M(X, T) = -all.first.y();
    M(Y, T) = all.first.x();
    M(T, T) = all.second;
    for (int d = 0; d < n - 3; ++d)
        for (int r : {X, Y, T})
            M(d, r) = M(r, d);
    M(T, X) = M(X, T);
    M(T, Y) = M(Y, T);
}

void momentum(const RodModel& model, const Kinematics& kin, const GaussField& field, const std::vector<Vec2>& u,
              Eigen::VectorXd& p) {
    p.setZero(model.dofs());
    Vec2 total = Vec2::Zero();
    double spin = 0.0;
    for (int side = 0; side < 2; ++side) {
        Vec2 push = Vec2::Zero();
        double turn = 0.0; // about the middle, of everything beyond
        for (int k = static_cast<int>(model.side(side).size()) - 1; k >= 0; --k) {
            const SegmentView v = view(model, kin, side, k);
            Vec2 pushInside = Vec2::Zero();
            double turnInside = 0.0, ownWork = 0.0;
            forMass(v, [&](std::size_t g) {
                const Vec2 mu = field.mass[g] * u[g];
                pushInside += mu;
                turnInside += cross(field.arm[g], mu);
                ownWork += field.own[g].dot(mu);
            });
            p[v.seg->dof] += v.seg->signedLength * (turn - cross(v.centroid, push)) + ownWork;
            push += pushInside;
            turn += turnInside;
        }
        total += push;
        spin += turn;
    }
    p[model.dofX()] = total.x();
    p[model.dofY()] = total.y();
    p[model.dofTheta()] = spin;
}

void velocityField(const RodModel& model, const Kinematics& kin, const GaussField& field, const Eigen::VectorXd& v,
                   std::vector<Vec2>& u) {
    u.resize(field.arm.size());
    for (int side = 0; side < 2; ++side) {
        Vec2 drift(v[model.dofX()], v[model.dofY()]);
        double turn = v[model.dofTheta()];
        for (int k = 0; k < static_cast<int>(model.side(side).size()); ++k) {
            const SegmentView s = view(model, kin, side, k);
            const double rate = v[s.seg->dof];
            forMass(s, [&](std::size_t g) { u[g] = drift + turn * perp(field.arm[g]) + rate * field.own[g]; });
            const double rotation = s.seg->signedLength * rate;
            drift -= rotation * perp(s.centroid);
            turn += rotation;
        }
    }
}

void inertialForce(const RodModel& model, const Kinematics& kin, const GaussField& field, const Eigen::VectorXd& v,
                   const std::vector<Vec2>& u, Eigen::VectorXd& force) {
    force.setZero(model.dofs());
    Vec2 total = Vec2::Zero();
    for (int side = 0; side < 2; ++side) {
        const int count = static_cast<int>(model.side(side).size());
        double turn = v[model.dofTheta()]; // of the tangent at the outer end of the segment
        for (const Segment& seg : model.side(side))
            turn += seg.signedLength * v[seg.dof];
        Vec2 push = Vec2::Zero(); // of everything beyond
        for (int k = count - 1; k >= 0; --k) {
            const SegmentView s = view(model, kin, side, k);
            const double rate = v[s.seg->dof], length = s.seg->signedLength;
            turn -= length * rate; // at the inner end
            const Vec2 t = kin.segmentTangent(side, k), normal = perp(t);
            double along[RodModel::kGauss], across[RodModel::kGauss];
            bendingOfField(length, kin.segmentArc(side, k).curvature * length, along, across);
            Vec2 pushInside = Vec2::Zero();
            double mass = 0.0, ownPower = 0.0;
            for (int i = 0; i < RodModel::kGauss; ++i) {
                const auto g = static_cast<std::size_t>(s.base + i);
                const Vec2 mu = field.mass[g] * u[g];
                mass += field.mass[g];
                pushInside += mu;
                ownPower += mu.dot(turn * perp(field.own[g]) + rate * (along[i] * t + across[i] * normal));
            }
            // The arm of all beyond is measured from the centroid of the segment, which moves as its own mass does.
            force[s.seg->dof] += length * cross(push, pushInside) / mass + ownPower;
            push += pushInside;
            for (std::size_t g = s.firstCarried; g < s.endCarried; ++g) {
                const CarriedPoint& c = model.carried()[g - static_cast<std::size_t>(model.gaussPoints())];
                const Arc& arc = kin.segmentArc(side, k);
                const Vec2 bending =
                    chordSecondDerivative(arc, c.local) - c.local * c.local * c.ahead * arc.tangentAt(c.local);
                const Vec2 mu = field.mass[g] * u[g];
                force[s.seg->dof] += mu.dot(turn * perp(field.own[g]) + rate * bending);
                push += mu;
            }
        }
        total += push;
    }
    force[model.dofTheta()] = cross(total, Vec2(v[model.dofX()], v[model.dofY()]));
}

void uniformForce(const RodModel& model, const Kinematics& kin, const GaussField& field, const Vec2& acceleration,
                  Eigen::VectorXd& force) {
    force.setZero(model.dofs());
    const double lambda = model.definition().linearMass;
    double spin = 0.0;
    for (int side = 0; side < 2; ++side) {
        double mass = 0.0;
        Vec2 first = Vec2::Zero();
        for (int k = static_cast<int>(model.side(side).size()) - 1; k >= 0; --k) {
            const SegmentView v = view(model, kin, side, k);
            double ownWork = 0.0;
            forMass(v, [&](std::size_t g) { ownWork += field.mass[g] * field.own[g].dot(acceleration); });
            const double f = v.seg->signedLength;
            force[v.seg->dof] += f * cross(first - mass * v.centroid, acceleration) + ownWork;
            const double m = lambda * std::abs(f);
            first += m * v.centroid; // the centroid of a uniform arc is its centre of mass
            mass += m;
            for (std::size_t g = v.firstCarried; g < v.endCarried; ++g) {
                first += field.mass[g] * field.arm[g];
                mass += field.mass[g];
            }
        }
        spin += cross(first, acceleration);
    }
    force[model.dofX()] = model.mass() * acceleration.x();
    force[model.dofY()] = model.mass() * acceleration.y();
    force[model.dofTheta()] = spin;
}

double kineticEnergy(const GaussField& field, const std::vector<Vec2>& u) {
    double sum = 0.0;
    for (std::size_t g = 0; g < u.size(); ++g)
        sum += field.mass[g] * u[g].squaredNorm();
    return 0.5 * sum;
}

Vec2 massCentre(const Kinematics& kin, const GaussField& field) {
    Vec2 first = Vec2::Zero();
    double mass = 0.0;
    for (std::size_t g = 0; g < field.mass.size(); ++g) {
        first += field.mass[g] * field.arm[g];
        mass += field.mass[g];
    }
    return kin.middle() + first / mass;
}

} // namespace supercircle::rod
