#pragma once
// Simulation of an experiment: backward Euler and Newton's method. Steps end at given times. Their length is limited by
// the travel of the crosshead and halved where Newton's method fails or a snap occurs.

#include "tests/reference_simulator/contact.h"

#include <string>
#include <vector>

namespace supercircle::reference_simulator {

struct Resolution {
    int edges = 100;       ///< of a specimen, an even number
    double travel = 4e-5;  ///< of the crosshead in a step, m
    double longest = 0.05; ///< step, s
    ContactSettings contact;
};

/// Set-up with its true parameters.
struct Setup {
    std::vector<Specimen> specimens;
    std::vector<Obstacle> obstacles;
    double friction = 0.3;
    Vec2 gravity = Vec2::Zero();
    double crossheadOffset = 0.0; ///< of the crosshead at displacement 0, upwards, m
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
    double maxCurvatureChange = 0.0;        ///< of curvature, 1/m
    std::size_t steps = 0, iterations = 0;
};

class Simulation {
public:
    Simulation(const Setup& setup, const Resolution& resolution);

    /// Lets the specimens come to rest under their weight, with the crosshead at displacement 0.
    bool settle(double seconds);
    /// Follows the drive. Steps end at every one of `times` (ascending).
    Trace run(const Drive& drive, const std::vector<double>& times, const std::vector<Marker>& markers);
    [[nodiscard]] double force() const { return force_; }
    [[nodiscard]] Vec2 point(const Marker& marker) const;
    [[nodiscard]] const Eigen::VectorXd& positions() const { return x_; }
    [[nodiscard]] const std::vector<NodalRod>& rods() const { return rods_; }
    [[nodiscard]] double energy() const; ///< elastic, J

private:
    struct Attempt {
        bool converged = false;
        Eigen::VectorXd x;
        double crosshead = 0.0, force = 0.0;
    };
    void placeRods();
    [[nodiscard]] Attempt attempt(double target, double dt);
    /// Residual of a step, its derivative, and the force on the crosshead.
    void assemble(const Eigen::VectorXd& x, double crosshead, double target, double dt, Eigen::VectorXd& residual,
                  LinearSystem* tangent, CrossheadForce& onCrosshead) const;
    void addInertiaAndLoads(const Eigen::VectorXd& x, double dt, Eigen::VectorXd& residual,
                            LinearSystem* tangent) const;
    void addDrag(const Eigen::VectorXd& x, Eigen::VectorXd& residual, LinearSystem* tangent) const;
    void applyClamps(const Eigen::VectorXd& x, double target, Eigen::VectorXd& residual, LinearSystem* tangent,
                     CrossheadForce& onCrosshead) const;
    [[nodiscard]] bool newton(double target, double dt, Attempt& a);
    void accept(Attempt&& a, double dt);
    bool advance(double target, double dt);
    [[nodiscard]] bool compliantMachine() const { return setup_.effects.machineStiffness > 0.0; }

    Setup setup_;
    Resolution resolution_;
    std::vector<NodalRod> rods_;
    std::vector<Contacts> contacts_; ///< one element, built after the rods
    std::unique_ptr<LinearSystem> system_;
    Eigen::VectorXd x_, v_, mass_, drag_; ///< drag_: elongation of the tangential springs of the walls
    double t_ = 0.0, crosshead_ = 0.0, lastTarget_ = 0.0, force_ = 0.0, lastDt_ = 0.0;
    bool plateOnCrosshead_ = false;
    std::size_t steps_ = 0, iterations_ = 0;
};

/// Readings of the load cell at given times.
std::vector<double> readings(const Trace& trace, const Effects& effects, const std::vector<double>& times);
/// Subtracts the mean of the first half second, as testing machines do.
void zeroAtStart(const std::vector<double>& times, std::vector<double>& force);
/// Motion behind a backlash, which is lost at each change of direction.
Drive behindBacklash(const Drive& drive, double play);

} // namespace supercircle::reference_simulator
