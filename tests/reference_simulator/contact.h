#pragma once
// Smooth contact. Sample points along a rod (several per edge, on the curve through its nodes) are pushed away from
// obstacles and from the other rod by a penalty that sets in quadratically; friction is a spring along the surface that
// slips at Coulomb's limit (return mapping), so that what sticks stays. No complementarity problem is solved anywhere.

#include "tests/reference_simulator/linear.h"
#include "tests/reference_simulator/rod.h"

#include <vector>

namespace supercircle::oracle {

struct Obstacle {
    bool cylinder = false;
    Vec2 point = Vec2::Zero(); ///< axis, or any point of the plane
    Vec2 normal = Vec2(0, 1);
    double radius = 0.0;
    bool onHead = false;
};

struct ContactSettings {
    double stiffness = 1e6;  ///< of a sample along the normal, N/m
    double tangential = 1e6; ///< of its friction spring, N/m
    double onset = 2e-7;     ///< half the gap over which the penalty sets in, m
    int perEdge = 4;         ///< samples
};

/// Forces on what the head carries and their derivatives, for a head whose place is an unknown.
struct HeadForce {
    double value = 0.0, byHead = 0.0; ///< upwards on the head, N; its derivative by the head's height, N/m
    Eigen::VectorXd column, row;      ///< derivative of the residual by the head's height; of `value` by x
};

class Contacts {
public:
    Contacts(const std::vector<NodalRod>& rods, const std::vector<Obstacle>& obstacles, double friction,
             const Effects& effects, const ContactSettings& settings);

    /// Adds contact forces to the residual (minus the force) and their derivative. `old` is x at the step's beginning.
    /// @param head height of the head above its place at displacement 0 @param oldHead at the step's beginning
    void addForces(const Eigen::VectorXd& x, const Eigen::VectorXd& old, double head, double oldHead, double dt,
                   Eigen::VectorXd& residual, LinearSystem* tangent, HeadForce& onHead) const;
    void commit(const Eigen::VectorXd& x, const Eigen::VectorXd& old, double head, double oldHead, double dt);
    /// Forgets the history of friction, not the forces of springs.
    void rest();

private:
    static constexpr int kMost = 8; ///< nodes in a contact
    struct Sample {
        int rod = 0;
        Weights at;          ///< nodes counted in the rod
        double length = 0.0; ///< of rod that it stands for, m
        // memory
        double spring = 0.0, fresh = 1.0, way = 0.0; ///< m; 1: rested; m
        int partner = -1;                            ///< obstacle, or obstacles + rod; -1: none
    };
    struct Touch {
        int count = 0;
        int node[kMost] = {};
        double weight[kMost] = {}, bend[kMost] = {}; ///< of the relative place; of the other curve's slope
        Vec2 normal = Vec2::Zero(), tangent = Vec2::Zero();
        double gap = 0.0, distance = 1e30, slope = 0.0, curve = 0.0; ///< slope |c'|, curve A (0: fixed point or plane)
        int partner = -1;
        bool onHead = false;
        double patch = 1.0; ///< factor of the friction coefficient at this place
    };
    struct Friction {
        double force = 0.0, byNormal = 0.0, bySlip = 0.0; ///< N along the tangent; derivatives
        double spring = 0.0, fresh = 1.0, way = 0.0;
    };
    [[nodiscard]] Vec2 pointOf(const Sample& s, const Eigen::VectorXd& x) const;
    [[nodiscard]] bool touchObstacle(const Sample& s, std::size_t o, const Eigen::VectorXd& x, double head,
                                     Touch& t) const;
    [[nodiscard]] bool touchRod(const Sample& s, int other, const Eigen::VectorXd& x, Touch& t) const;
    void start(const Sample& s, Touch& t) const;
    [[nodiscard]] double slip(const Touch& t, const Eigen::VectorXd& x, const Eigen::VectorXd& old, double head,
                              double oldHead) const;
    [[nodiscard]] Friction friction(const Sample& s, const Touch& t, double load, double along, double dt) const;
    struct Pressure {
        double value = 0.0, slope = 0.0; ///< N, N/m
    };
    [[nodiscard]] Pressure repulsion(double gap) const;
    [[nodiscard]] Pressure attraction(const Sample& s, double gap) const;
    void add(const Sample& s, const Touch& t, const Eigen::VectorXd& x, const Eigen::VectorXd& old, double head,
             double oldHead, double dt, Eigen::VectorXd& residual, LinearSystem* tangent, HeadForce& onHead) const;
    template <class Visit>
    void each(const Eigen::VectorXd& x, double head, Visit&& visit) const;

    const std::vector<NodalRod>& rods_;
    std::vector<Obstacle> obstacles_;
    double friction_;
    Effects effects_;
    ContactSettings settings_;
    double stiffness_, tangential_, reach_;
    std::vector<Sample> samples_;
};

} // namespace supercircle::oracle
