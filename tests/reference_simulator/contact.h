#pragma once
// Smooth contact. Several sample points per edge lie on the curve through the nodes of a rod. A penalty that sets in
// quadratically pushes them away from obstacles and from the other rod. Friction is a tangential spring that slips at
// Coulomb's limit (return mapping), so that sticking points do not creep. There is no complementarity problem.

#include "tests/reference_simulator/linear_system.h"
#include "tests/reference_simulator/rod.h"

#include <vector>

namespace supercircle::reference_simulator {

struct Obstacle {
    bool cylinder = false;
    Vec2 point = Vec2::Zero(); ///< m, axis, or any point of the plane
    Vec2 normal = Vec2(0, 1);
    double radius = 0.0; ///< cylinder, m
    bool onCrosshead = false;
};

struct ContactSettings {
    double stiffness = 1e6;  ///< of a sample along the normal, N/m
    double tangential = 1e6; ///< of its friction spring, N/m
    double onset = 2e-7;     ///< half the gap over which the penalty sets in, m
    int samplesPerEdge = 4;
};

/// Force on the crosshead and its derivatives, where the height of the crosshead is an unknown.
struct CrossheadForce {
    double value = 0.0, byCrosshead = 0.0; ///< upwards, N; derivative by the height of the crosshead, N/m
    Eigen::VectorXd column, row;           ///< derivatives: of the residual by that height, of `value` by x
};

class Contacts {
public:
    Contacts(const std::vector<NodalRod>& rods, const std::vector<Obstacle>& obstacles, double friction,
             const Effects& effects, const ContactSettings& settings);

    /// Adds contact forces to the residual (minus the force) and their derivative.
    /// @param old x at the beginning of the step
    /// @param crosshead height above its position at displacement 0, m @param oldCrosshead at the beginning of the step
    void addForces(const Eigen::VectorXd& x, const Eigen::VectorXd& old, double crosshead, double oldCrosshead,
                   double dt, Eigen::VectorXd& residual, LinearSystem* tangent, CrossheadForce& onCrosshead) const;
    void commit(const Eigen::VectorXd& x, const Eigen::VectorXd& old, double crosshead, double oldCrosshead, double dt);
    /// Resets the history of friction, but not the elastic forces.
    void resetHistory();

private:
    static constexpr int kMaxNodes = 8; ///< nodes in a contact
    struct Sample {
        int rod = 0;
        Weights at;          ///< nodes are numbered within the rod
        double length = 0.0; ///< length of rod that it represents, m
        // state
        double elongation = 0.0, ageing = 1.0, slidDistance = 0.0; ///< m; share of ageing, 1 after a long rest; m
        int partner = -1;                                          ///< obstacle, or obstacles + rod; -1: none
    };
    struct ContactGeometry {
        int count = 0;
        int node[kMaxNodes] = {};
        double weight[kMaxNodes] = {};      ///< of the relative position
        double slopeWeight[kMaxNodes] = {}; ///< of the tangent of the other curve
        Vec2 normal = Vec2::Zero(), tangent = Vec2::Zero();
        double gap = 0.0, distance = 1e30;       ///< m
        double slope = 0.0, curvatureTerm = 0.0; ///< |c'| and A of contact.cpp; 0: fixed point or plane
        int partner = -1;
        bool onCrosshead = false;
        double frictionFactor = 1.0; ///< factor of the friction coefficient at this position
    };
    struct Friction {
        double force = 0.0, byNormal = 0.0, bySlip = 0.0; ///< N along the tangent; derivatives
        double elongation = 0.0, ageing = 1.0, slidDistance = 0.0;
    };
    [[nodiscard]] Vec2 pointOf(const Sample& s, const Eigen::VectorXd& x) const;
    [[nodiscard]] bool findObstacleContact(const Sample& s, std::size_t o, const Eigen::VectorXd& x, double crosshead,
                                           ContactGeometry& t) const;
    [[nodiscard]] bool findRodContact(const Sample& s, int other, const Eigen::VectorXd& x, ContactGeometry& t) const;
    void setSampleNodes(const Sample& s, ContactGeometry& t) const;
    [[nodiscard]] double slip(const ContactGeometry& t, const Eigen::VectorXd& x, const Eigen::VectorXd& old,
                              double crosshead, double oldCrosshead) const;
    [[nodiscard]] Friction friction(const Sample& s, const ContactGeometry& t, double load, double along,
                                    double dt) const;
    struct NormalForce {
        double value = 0.0, slope = 0.0; ///< N, N/m
    };
    [[nodiscard]] NormalForce repulsion(double gap) const;
    [[nodiscard]] NormalForce adhesion(const Sample& s, double gap) const;
    void add(const Sample& s, const ContactGeometry& t, const Eigen::VectorXd& x, const Eigen::VectorXd& old,
             double crosshead, double oldCrosshead, double dt, Eigen::VectorXd& residual, LinearSystem* tangent,
             CrossheadForce& onCrosshead) const;
    template <class Visit>
    void forEachContact(const Eigen::VectorXd& x, double crosshead, Visit&& visit) const;

    const std::vector<NodalRod>& rods_;
    std::vector<Obstacle> obstacles_;
    double friction_;
    Effects effects_;
    ContactSettings settings_;
    double stiffness_, tangential_, reach_;
    std::vector<Sample> samples_;
};

} // namespace supercircle::reference_simulator
