#include "tests/supercircle/coulomb/generator.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace generator {

using supercircle::coulomb::Body;
using supercircle::coulomb::Contact;
using supercircle::coulomb::Problem;
using Row = Eigen::Matrix<double, 2, Eigen::Dynamic>;

std::uint64_t Random::bits() {
    state_ += 0x9E3779B97F4A7C15ull;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
    return z ^ (z >> 31);
}

double Random::uniform(double from, double to) {
    return from + (to - from) * static_cast<double>(bits() >> 11) * 0x1p-53;
}

int Random::index(int count) {
    return static_cast<int>(bits() % static_cast<std::uint64_t>(count));
}

namespace {

Eigen::MatrixXd noise(Eigen::Index rows, Eigen::Index cols, Random& random) {
    Eigen::MatrixXd m(rows, cols);
    for (Eigen::Index j = 0; j < cols; ++j)
        for (Eigen::Index i = 0; i < rows; ++i)
            m(i, j) = random.uniform(-1.0, 1.0);
    return m;
}

Eigen::MatrixXd positiveDefinite(int n, double condition, double scale, Random& random) {
    const Eigen::MatrixXd q = Eigen::HouseholderQR<Eigen::MatrixXd>(noise(n, n, random)).householderQ();
    Eigen::VectorXd values(n);
    for (int i = 0; i < n; ++i)
        values[i] = scale * std::pow(condition, random.uniform());
    const Eigen::MatrixXd a = q * values.asDiagonal() * q.transpose();
    return 0.5 * (a + a.transpose());
}

} // namespace

Problem cloud(const Cloud& options, Random& random) {
    Problem problem;
    problem.dt = 1e-3;
    for (int b = 0; b < options.bodies; ++b) {
        const double mass = std::pow(options.massRatio, random.uniform());
        problem.bodies.push_back(
            {positiveDefinite(options.freedoms, options.condition, mass, random), noise(options.freedoms, 1, random)});
    }
    for (int c = 0; c < options.contacts; ++c) {
        if (c > 0 && random.uniform() < options.duplicates) {
            problem.contacts.push_back(problem.contacts[random.index(c)]);
            continue;
        }
        Contact contact;
        contact.a = random.index(options.bodies);
        contact.Ha = noise(2, options.freedoms, random);
        if (random.uniform() < options.self) {
            contact.b = contact.a;
        } else {
            contact.b = random.index(options.bodies + 1) - 1;
            if (contact.b == contact.a)
                contact.b = -1;
        }
        if (contact.b >= 0)
            contact.Hb = noise(2, options.freedoms, random);
        contact.mu = options.mu;
        contact.w[0] = random.uniform() < 0.5 ? 0.0 : random.uniform(0.0, 0.5);
        problem.contacts.push_back(contact);
    }
    return problem;
}

Problem tower(int boxes, double mu, double massRatio, double dt, Random& random) {
    Problem problem;
    problem.dt = dt;
    const double half = 0.5;
    for (int b = 0; b < boxes; ++b) {
        const double mass = std::pow(massRatio, random.uniform());
        Body body;
        body.A = Eigen::Vector3d(mass, mass, mass / 6.0).asDiagonal();
        body.vFree = Eigen::Vector3d(random.uniform(-0.02, 0.02), -9.81 * dt, random.uniform(-0.01, 0.01));
        problem.bodies.push_back(body);
        for (const double x : {-half, half}) {
            Contact contact;
            contact.a = b;
            contact.b = b - 1;
            contact.mu = mu;
            contact.Ha.resize(2, 3); // point (x, -half) of the upper box: v + omega perp
            contact.Ha << 0.0, 1.0, x, 1.0, 0.0, half;
            if (b > 0) {
                contact.Hb.resize(2, 3); // point (x, +half) of the lower one
                contact.Hb << 0.0, -1.0, -x, -1.0, 0.0, half;
            }
            problem.contacts.push_back(contact);
        }
    }
    return problem;
}

namespace {

constexpr int kElements = 15;
constexpr int kFreedoms = kElements + 3;
constexpr double kRadius = 19.2e-3;
constexpr double kThickness = 0.5e-3;
constexpr double kWidth = 10e-3;
constexpr double kModulus = 2.2e9;
constexpr double kDensity = 1270.0;
constexpr double kAngle = 0.75 * 2.0 * 3.14159265358979323846;

/// Where curvature i sits: left elements first, right elements next, the middle one, then x, y, theta.
int slot(int element) {
    constexpr int half = kElements / 2;
    return element < half ? element : element == half ? 2 * half : element - 1;
}

/// 2 x 18 Jacobian of the centre-line point at angle `phi` (0 = crown at the bottom, shell open upwards), offset along
/// the outward normal by `offset`, radius R about the origin. s = R phi.
Eigen::Matrix<double, 2, kFreedoms> pointJacobian(double phi, double offset) {
    const auto at = [](double a) { return Eigen::Vector2d(kRadius * std::sin(a), -kRadius * std::cos(a)); };
    const auto perp = [](const Eigen::Vector2d& a) { return Eigen::Vector2d(-a.y(), a.x()); };
    const Eigen::Vector2d point = at(phi) * (1.0 + offset / kRadius);
    Eigen::Matrix<double, 2, kFreedoms> J = Eigen::Matrix<double, 2, kFreedoms>::Zero();
    J.col(kElements)[0] = 1.0;
    J.col(kElements + 1)[1] = 1.0;
    J.col(kElements + 2) = perp(point - at(0.0));
    for (int i = 0; i < kElements; ++i) {
        const double from = kAngle * (static_cast<double>(i) / kElements - 0.5);
        const double to = kAngle * (static_cast<double>(i + 1) / kElements - 0.5);
        const double low = std::max(from, std::min(0.0, phi));
        const double high = std::min(to, std::max(0.0, phi));
        if (high <= low)
            continue;
        const double middle = 0.5 * (low + high);
        const double span = high - low;
        const double shrink = std::sin(0.5 * span) / (0.5 * span); // centroid of an arc
        const double length = (phi > 0.0 ? 1.0 : -1.0) * kRadius * span;
        J.col(slot(i)) = length * perp(point - shrink * at(middle));
    }
    return J;
}

Eigen::MatrixXd shellMatrix(double dt) {
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(kFreedoms, kFreedoms);
    const double lambda = kDensity * kWidth * kThickness;
    constexpr int samples = 8 * kElements;
    for (int k = 0; k < samples; ++k) {
        const auto J = pointJacobian(kAngle * ((k + 0.5) / samples - 0.5), 0.0);
        A += lambda * kRadius * kAngle / samples * J.transpose() * J;
    }
    const double bending = kModulus * kWidth * std::pow(kThickness, 3) / 12.0;
    for (int i = 0; i < kElements; ++i)
        A(slot(i), slot(i)) += dt * dt * bending * kRadius * kAngle / kElements;
    return A;
}

} // namespace

Problem nest(const Nest& options, Random& random) {
    Problem problem;
    problem.dt = options.dt;
    const Eigen::MatrixXd A = shellMatrix(options.dt);
    const Eigen::MatrixXd inverse = A.inverse();
    for (int column = 0; column < options.side; ++column)
        for (int level = 0; level < options.shells; ++level) {
            Eigen::VectorXd impulse = Eigen::VectorXd::Zero(kFreedoms);
            impulse[kElements + 1] = -9.81 * options.dt * A(kElements + 1, kElements + 1);
            if (level == options.shells - 1)
                impulse[kElements + 1] -= options.force * options.dt * random.uniform(0.5, 1.0);
            impulse[kElements] = 0.2 * options.force * options.dt * random.uniform(-1.0, 1.0);
            problem.bodies.push_back({A, inverse * impulse});
        }
    const auto touch = [&](int upper, int lower, double phi, double offsetUpper, double offsetLower, double lowerPhi) {
        Contact contact;
        contact.a = upper;
        contact.b = lower;
        contact.mu = options.mu;
        contact.w[0] = random.uniform() * random.uniform() * options.jitter / options.dt;
        Eigen::Matrix2d frame; // normal towards the upper shell, tangent along the arc
        frame << -std::sin(phi), std::cos(phi), std::cos(phi), std::sin(phi);
        contact.Ha = frame * pointJacobian(phi, offsetUpper);
        if (lower >= 0)
            contact.Hb = -(frame * pointJacobian(lowerPhi, offsetLower));
        problem.contacts.push_back(contact);
    };
    const double h = 0.5 * kThickness;
    for (int column = 0; column < options.side; ++column) {
        const int base = column * options.shells;
        for (int level = 0; level < options.shells; ++level)
            for (int k = 0; k < (level == 0 ? 3 : options.perPair); ++k) {
                const double spread = level == 0 ? 0.1 : 0.4;
                const double phi = kAngle * random.uniform(-spread, spread);
                touch(base + level, level == 0 ? -1 : base + level - 1, phi, h, -h, phi);
            }
        for (int level = 0; column > 0 && level < options.shells; ++level)
            touch(base + level, base + level - options.shells, -1.4, h, h, 1.4);
    }
    return problem;
}

} // namespace generator
