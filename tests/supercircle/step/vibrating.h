#pragma once
// A rod about its natural shape, in the shape of one of its modes, and what is seen of its swing.

#include "supercircle/rod/modes.h"
#include "supercircle/support/dense.h"
#include "tests/supercircle/step/setup.h"

#include <Eigen/Cholesky>

namespace supercircle::test {

/// Without the damping that games have by default.
inline step::Settings undampedSettings(bool game) {
    step::Settings s = game ? step::gameSettings() : step::Settings{};
    s.dampingRatio = 0.0;
    return s;
}

/// A rod about its natural shape, with the shape of one of its modes.
struct Vibrating {
    step::World world;
    Eigen::VectorXd natural, shape; ///< of the mode, with a displacement of the last tip against the middle of 1 m
    double frequency = 0.0;         ///< of the mode, rad/s

    [[nodiscard]] step::Rod& rod() { return world.rods[0]; }
    /// Energy of motion and bending, J.
    [[nodiscard]] double energy() {
        return rod::kineticEnergy(rod().gauss, rod().u) + rod::bendingEnergy(rod().model, rod().q);
    }
};

/// `clamped`: at its first tip. `loaded`: the shape of a load at its tip instead of the mode.
inline Vibrating vibrating(const rod::RodDefinition& d, bool clamped, int mode, bool loaded = false) {
    Vibrating v;
    put(v.world, d, {0.0, 0.0}, 0.0, 0.3);
    step::Rod& r = v.rod();
    const Eigen::Index n = r.model.dofs();
    v.natural = r.q;
    Eigen::MatrixXd held(0, n);
    if (d.closed) {
        held.resize(3, n);
        r.kin.closureRows(r.model, held.topRows<3>());
    }
    const rod::MaterialPoint root = rod::locate(r.model, 0, 0.0), tip = rod::locate(r.model, d.length);
    Eigen::Matrix<double, 2, Eigen::Dynamic> pair(2, n);
    Eigen::RowVectorXd turn(n);
    if (clamped) {
        step::Hold hold;
        hold.s = 0.0;
        hold.target.point = r.kin.point(root);
        hold.target.angle = r.kin.angle(root);
        r.holds.push_back(hold);
        r.kin.pointRows(r.model, root, Vec2::Zero(), Vec2::UnitX(), Vec2::UnitY(), pair);
        r.kin.angleRow(r.model, root, turn);
        held.resize(3, n);
        held << pair, turn;
    }
    const Eigen::VectorXd all = rod::circularFrequencies(r.model, r.q, held);
    v.frequency = all[mode];
    // The mode is in the null space of K - omega^2 M on the motions that are not held.
    Eigen::MatrixXd M;
    rod::massMatrix(r.model, r.kin, r.gauss, M);
    const Eigen::MatrixXd Z = held.rows() > 0 ? dense::nullSpaceBasis(held) : Eigen::MatrixXd::Identity(n, n);
    Eigen::MatrixXd K = Eigen::MatrixXd::Zero(n, n);
    rod::addBendingStiffness(r.model, 1.0, K);
    const Eigen::MatrixXd Kz = Z.transpose() * K * Z, Mz = Z.transpose() * M * Z;
    r.kin.pointRows(r.model, tip, Vec2::Zero(), Vec2::UnitX(), Vec2::UnitY(), pair);
    if (loaded) {
        v.shape = Z * Kz.llt().solve((Z.transpose() * pair.row(1).transpose()).eval());
    } else { // by inverse iteration with a shift beside the eigenvalue
        Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(Z.cols(), 1.0, 2.0).array().sin();
        const Eigen::MatrixXd shifted = Kz - 1.0001 * v.frequency * v.frequency * Mz;
        for (int i = 0; i < 8; ++i)
            x = dense::solveLdlt(shifted, Mz * x).normalized();
        v.shape = Z * x;
    }
    v.shape /= (pair * v.shape).norm();
    return v;
}

inline void bendTo(Vibrating& v, double amplitude) {
    step::Rod& r = v.rod();
    r.q = v.natural + amplitude * v.shape;
    step::refreshRod(r);
    if (!r.holds.empty()) { // to its place exactly, which the linear shape misses by its square
        const rod::MaterialPoint root = rod::locate(r.model, 0, 0.0);
        r.q[r.model.dofTheta()] -= r.kin.angle(root) - r.holds[0].target.angle;
        step::refreshRod(r);
        const Vec2 off = r.kin.point(root) - r.holds[0].target.point;
        r.q[r.model.dofX()] -= off.x();
        r.q[r.model.dofY()] -= off.y();
        step::refreshRod(r);
    }
    v.world.energyBalance = {};
    v.world.energyBalance.bending = v.world.energyBalance.added = v.energy();
}

/// What is seen of a motion.
struct Seen {
    double frequency = 0.0; ///< rad/s, from the zeros of the mode's coordinate
    double energy = 0.0;    ///< left, of that at the start
    double tip = 0.0;       ///< square of the amplitude of the mode's coordinate in the last period, of the first
};

inline Seen watch(Vibrating& v, double framesAPeriod, double periods, const step::Settings& settings) {
    step::Stepper stepper(settings);
    const double period = 2.0 * M_PI / v.frequency, frame = period / framesAPeriod, before = v.energy();
    const auto coordinate = [&] {
        return v.shape.head(v.rod().model.elements()).dot((v.rod().q - v.natural).head(v.rod().model.elements()));
    };
    double last = coordinate(), lastRate = 0.0, first = -1.0, end = 0.0, most = 0.0, mostFirst = 0.0;
    int zeros = 0;
    const int frames = static_cast<int>(std::lround(periods * framesAPeriod));
    for (int i = 0; i < frames; ++i) {
        REQUIRE(stepper.advance(v.world, frame, nullptr, {}).failure.empty());
        const double now = coordinate();
        const double rate = v.shape.head(v.rod().model.elements()).dot(v.rod().v.head(v.rod().model.elements()));
        // Amplitude from place and speed, so that no peak between frames is missed.
        const double size = now * now + std::pow(rate / v.frequency, 2);
        if (i < framesAPeriod)
            mostFirst = std::max(mostFirst, size);
        if (i >= frames - framesAPeriod)
            most = std::max(most, size);
        if ((last < 0.0) != (now < 0.0)) { // the zero of the cubic through places and speeds, by bisection
            double low = 0.0, high = 1.0;
            const auto cubic = [&](double x) {
                const double y = 1.0 - x;
                return y * y * (1.0 + 2.0 * x) * last + x * y * y * frame * lastRate + x * x * (3.0 - 2.0 * x) * now -
                       x * x * y * frame * rate;
            };
            for (int k = 0; k < 50; ++k) {
                const double middle = 0.5 * (low + high);
                ((cubic(middle) < 0.0) == (last < 0.0) ? low : high) = middle;
            }
            end = (i + low) * frame;
            first = zeros == 0 ? end : first;
            ++zeros;
        }
        last = now;
        lastRate = rate;
    }
    return {zeros > 1 ? M_PI * (zeros - 1) / (end - first) : 0.0, v.energy() / before, most / mostFirst};
}

inline rod::RodDefinition vibratingBeam(int elements = 16) {
    rod::RodDefinition d = strip(0.6, 1.0, elements);
    d.thickness = 0.007;
    d.linearMass = 0.05;
    d.bendingModulus = 2.0;
    return d;
}

} // namespace supercircle::test
