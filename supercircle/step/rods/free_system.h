#pragma once
// Rods that move freely together (private to step/rods; the scheme is said in free_motion.h): the equations of each,
// bodies of the host (not in use: free_groups.cpp), and the rows of holds and joints, which act on velocities. A group
// without joints is one rod.

#include "supercircle/step/contacts/contact_rows.h"
#include "supercircle/step/rods/free_equations.h"

namespace supercircle::step {

class FreeSystem {
public:
    FreeSystem(const World& world, const Settings& settings, const std::vector<BodyMotion>& motion,
               std::vector<RodWork>& rods, FreeGroup& group)
        : world_(world), motion_(motion), rods_(rods), g_(group), tolerance_(1e-4 * settings.contact.tolerance) {}

    /// Places of all rows, and the state of the bodies; rods are evaluated. Whether the joints are closed, so that only
    /// motion opens them.
    [[nodiscard]] bool begin();
    [[nodiscard]] bool hasRows() const { return g_.rows > 0; }
    /// Geometry of all rods at their q and v.
    void evaluate();
    /// Of all rods and bodies, for stages of `tau` s.
    void factor(double tau);
    /// Starts a stage (0 or 1) from the state, or from what the first one leads to.
    void startStage(std::size_t stage);
    /// Solves it, at the time `ahead`. False: its iteration does not come to an end, or a tether that is taut does not
    /// pull, or a slack one becomes taut.
    [[nodiscard]] bool solve(std::size_t stage, double tau, double ahead);
    /// Removes from `change` of all rods and bodies what the rows do not allow.
    void constrainChange();
    /// Takes the second stage as the state, adds to impulses and work of the joints.
    void take();
    /// Puts all back to where holds and joints want it, from where the velocities have led by an error of third order.
    /// False: it could not.
    [[nodiscard]] bool close(double ahead);

    /// Kinetic, of bending, gravity and forces, J: of the state, whose geometry was evaluated last.
    [[nodiscard]] double energyAtStart();
    /// Of the second stage, solved last, `ahead` s from the start of the step, to which materials have aged, J.
    [[nodiscard]] double energyAtEnd(double ahead);
    /// Of bending alone, by the rods' own law, J.
    [[nodiscard]] double bendingAtEnd();

    [[nodiscard]] std::size_t size() const { return g_.rods.size(); }
    [[nodiscard]] const Rod& rod(std::size_t i) const { return world_.rods[g_.rods[i]]; }
    [[nodiscard]] RodWork& work(std::size_t i) { return rods_[g_.rods[i]]; }
    [[nodiscard]] FreeWork& free(std::size_t i) { return work(i).free; }
    [[nodiscard]] FreeEquations equations(std::size_t i) { return {world_, rod(i), work(i)}; }

private:
    /// The two points of a joint, and the motion of the other one as far as it is given.
    struct Places {
        Vec2 a = Vec2::Zero(), b = Vec2::Zero();
        double angleA = 0.0, angleB = 0.0;
        Vec2 offset = Vec2::Zero();   ///< of b from what it is fixed to
        Vec2 velocity = Vec2::Zero(); ///< given
        double spin = 0.0;            ///< given
    };
    enum class At { State, First, Second }; ///< which state of the bodies

    [[nodiscard]] const Link& linkOf(const FreeJoint& j) const {
        return world_.links[static_cast<std::size_t>(j.link)];
    }
    [[nodiscard]] Places placesOf(const FreeJoint& j, double ahead, At at);
    [[nodiscard]] Eigen::Vector3d gapOf(const FreeJoint& j, const Places& p) const;
    [[nodiscard]] Eigen::Vector3d givenRate(const FreeJoint& j, const Places& p) const;
    [[nodiscard]] bool isClosed(const FreeJoint& j);
    [[nodiscard]] double potentialOf(std::size_t i);
    void listBodies();
    void listRows();
    void collectPulls();
    void jointRows(const FreeJoint& j, double ahead, At at);
    void rows(double ahead, At at);
    void iterate(std::size_t stage, double tau, double ahead);
    [[nodiscard]] bool record(std::size_t stage, double ahead);
    void solveSchur();
    void gather(const std::vector<Eigen::Index>& place, Eigen::VectorXd& own) const;
    void scatter(const Eigen::VectorXd& own, const std::vector<Eigen::Index>& place);
    /// g.impulse -= C x for the vectors x of rods and bodies that are named.
    template <class OfRod, class OfBody>
    void takeOff(const OfRod& ofRod, const OfBody& ofBody);
    /// Solves for the impulses y of the rows, x += A^-1 C^T y.
    template <class OfRod, class OfBody>
    void addSolved(const OfRod& ofRod, const OfBody& ofBody);

    const World& world_;
    const std::vector<BodyMotion>& motion_;
    std::vector<RodWork>& rods_;
    FreeGroup& g_;
    /// Of a stage, relative to its motion. A hundredth of it would be lost in round-off, a hundred times of it would be
    /// seen in the angular momentum of long runs.
    double tolerance_;
};

} // namespace supercircle::step
