#pragma once
// An experiment played by the second simulator: backward Euler, Newton's method, steps that end on wanted times, cut by
// the way of the head and halved where Newton or a snap asks for it.

#include "tests/reference_simulator/contact.h"

#include <string>
#include <vector>

namespace supercircle::oracle {

struct Resolution {
    int edges = 100;       ///< of a specimen, an even number
    double travel = 4e-5;  ///< of the head in a step, m
    double longest = 0.05; ///< step, s
    ContactSettings contact;
};

/// Everything as it truly is.
struct Setup {
    std::vector<Specimen> specimens;
    std::vector<Obstacle> obstacles;
    double friction = 0.3;
    Vec2 gravity = Vec2::Zero();
    double headShift = 0.0; ///< of the head at displacement 0, upwards, m
    Effects effects;
};

/// Commanded motion: break points of a piecewise linear displacement, downwards.
struct Drive {
    std::vector<double> time, displacement; ///< s, m
    [[nodiscard]] double at(double t) const;
};

struct Marker {
    int specimen = 0;
    double arcFraction = 0.0;
};

struct Trace {
    std::string failure;
    std::vector<double> time, force;        ///< of every step, s, N; resistance positive
    std::vector<std::vector<Vec2>> markers; ///< per marker, at every step
    double largestChange = 0.0;             ///< of curvature, 1/m
    std::size_t steps = 0, iterations = 0;
};

class Simulation {
public:
    Simulation(const Setup& setup, const Resolution& resolution);

    /// Lets everything come to rest under its weight with the head where it is.
    bool settle(double seconds);
    /// Drives the head; steps end at every one of `times` (ascending).
    Trace play(const Drive& drive, const std::vector<double>& times, const std::vector<Marker>& markers);
    [[nodiscard]] double force() const { return force_; }
    [[nodiscard]] Vec2 point(const Marker& marker) const;
    [[nodiscard]] const Eigen::VectorXd& positions() const { return x_; }
    [[nodiscard]] const std::vector<NodalRod>& rods() const { return rods_; }
    [[nodiscard]] double energy() const; ///< elastic, J

private:
    struct Attempt {
        bool converged = false;
        Eigen::VectorXd x;
        double head = 0.0, force = 0.0;
    };
    void placeRods();
    [[nodiscard]] Attempt attempt(double target, double dt);
    /// Residual of a step and its derivative; what it means for the head.
    void assemble(const Eigen::VectorXd& x, double head, double target, double dt, Eigen::VectorXd& residual,
                  LinearSystem* tangent, HeadForce& onHead) const;
    void addInertiaAndLoads(const Eigen::VectorXd& x, double dt, Eigen::VectorXd& residual,
                            LinearSystem* tangent) const;
    void addDrag(const Eigen::VectorXd& x, Eigen::VectorXd& residual, LinearSystem* tangent) const;
    void hold(const Eigen::VectorXd& x, double target, Eigen::VectorXd& residual, LinearSystem* tangent,
              HeadForce& onHead) const;
    [[nodiscard]] bool newton(double target, double dt, Attempt& a);
    void accept(Attempt&& a, double dt);
    bool advance(double target, double dt);
    [[nodiscard]] bool softMachine() const { return setup_.effects.machine > 0.0; }

    Setup setup_;
    Resolution resolution_;
    std::vector<NodalRod> rods_;
    std::vector<Contacts> contacts_; ///< one; built after the rods
    std::unique_ptr<LinearSystem> system_;
    Eigen::VectorXd x_, v_, mass_, drag_; ///< drag_: elongation of the springs to the walls
    double t_ = 0.0, head_ = 0.0, lastTarget_ = 0.0, force_ = 0.0, lastDt_ = 0.0;
    bool plateOnHead_ = false;
    std::size_t steps_ = 0, iterations_ = 0;
};

/// What the load cell reads of a force, at wanted times.
std::vector<double> readings(const Trace& trace, const Effects& effects, const std::vector<double>& times);
/// Takes the mean of the first half second off, as the machine does before a run.
void zeroAtStart(const std::vector<double>& times, std::vector<double>& force);
/// The motion behind a play that is lost at each change of direction.
Drive behindPlay(const Drive& drive, double play);

} // namespace supercircle::oracle
