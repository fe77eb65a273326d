#include "supercircle/step/rods/free_material.h"

#include "supercircle/step/rods/sdirk2.h"

#include <algorithm>
#include <cmath>

namespace supercircle::step {

namespace {

/// Calls `visit(branch, element, degree of freedom, place in the overstress)` for all branches and elements.
template <class Visit>
void forBranches(const Rod& rod, Visit&& visit) {
    const std::vector<effects::MaxwellBranch>& branches = rod.effects.material.model.branches;
    const int elements = rod.effects.material.on() ? rod.model.elements() : 0;
    for (std::size_t b = 0; b < branches.size(); ++b)
        for (int e = 0; e < elements; ++e)
            visit(branches[b], rod.model.dofOfElement(e),
                  b * static_cast<std::size_t>(elements) + static_cast<std::size_t>(e));
}

/// Calls `visit(branch, its overstress by degrees of freedom)` for all branches.
template <class Visit>
void forOverstress(const Rod& rod, const std::vector<double>& overstress, Visit&& visit) {
    const std::vector<effects::MaxwellBranch>& branches = rod.effects.material.model.branches;
    if (!rod.effects.material.on() || branches.empty())
        return;
    Eigen::VectorXd z = Eigen::VectorXd::Zero(rod.model.dofs());
    const auto* from = overstress.data();
    for (const effects::MaxwellBranch& b : branches) {
        for (int e = 0; e < rod.model.elements(); ++e)
            z[rod.model.dofOfElement(e)] = *from++;
        visit(b, z);
    }
}

} // namespace

void beginMaterial(const Rod& rod, FreeWork& f) {
    f.relaxed = f.softened = 0.0;
    f.overstress.clear();
    for (const std::vector<double>& branch : rod.effects.material.overstress)
        f.overstress.insert(f.overstress.end(), branch.begin(), branch.end());
    for (FreeStage& s : f.stages)
        s.overstress.assign(f.overstress.size(), 0.0);
}

void startMaterial(std::size_t stage, FreeWork& f) {
    std::vector<double>& start = f.stages[stage].overstress0;
    start = f.overstress;
    for (std::size_t k = 0; stage == 1 && k < start.size(); ++k)
        start[k] += kExtrapolate * (f.stages[0].overstress[k] - start[k]);
}

void relax(const Rod& rod, double tau, FreeStage& s) {
    forBranches(rod, [&](const effects::MaxwellBranch& b, int dof, std::size_t at) {
        s.overstress[at] = (s.overstress0[at] + tau * s.v[dof]) / (1.0 + tau / b.time);
    });
}

void addRelaxing(const Rod& rod, double tau, FreeStage& s, Eigen::VectorXd& force) {
    relax(rod, tau, s);
    forOverstress(rod, s.overstress, [&](const effects::MaxwellBranch& b, const Eigen::VectorXd& z) {
        rod::addBendingDrag(rod.model, b.stiffness, z, force);
    });
}

void addRelaxingTangent(const Rod& rod, double tau, Eigen::MatrixXd& A) {
    double factor = 0.0;
    if (rod.effects.material.on())
        for (const effects::MaxwellBranch& b : rod.effects.material.model.branches)
            factor += tau * tau * b.stiffness / (1.0 + tau / b.time);
    if (factor > 0.0)
        rod::addBendingStiffness(rod.model, factor, A);
}

bool yields(const Rod& rod, const FreeWork& f, double first, double second) {
    const effects::Material& m = rod.effects.material;
    if (!m.on() || std::isinf(m.model.yield))
        return false;
    for (int e = 0; e < rod.model.elements(); ++e)
        for (std::size_t stage = 0; stage < 2; ++stage) {
            const double curvature = f.stages[stage].q[rod.model.dofOfElement(e)];
            if (effects::springResponse(rod.model, m, e, curvature, stage == 0 ? first : second).hardened >
                m.hardened[static_cast<std::size_t>(e)])
                return true;
        }
    return false;
}

double bentEnergy(const Rod& rod, const Eigen::VectorXd& q, const std::vector<double>& overstress, double ahead) {
    if (!rod.effects.material.on())
        return rod::bendingEnergy(rod.model, q);
    double energy = effects::springEnergy(rod.model, rod.effects.material, q, ahead);
    forOverstress(rod, overstress, [&](const effects::MaxwellBranch& b, const Eigen::VectorXd& z) {
        energy += 0.5 * b.stiffness * rod::bendingForm(rod.model, z);
    });
    return energy;
}

void takeMaterial(const Rod& rod, double start, double size, FreeWork& f) {
    const effects::Material& m = rod.effects.material;
    if (!m.on())
        return;
    for (const Eigen::VectorXd* end : {&f.q, &f.stages[1].q})
        if (m.model.softening != 0.0) // the spring softens under load and loses its energy
            f.softened += 0.5 * (effects::springEnergy(rod.model, m, *end, start) -
                                 effects::springEnergy(rod.model, m, *end, start + size));
    for (std::size_t stage = 0; stage < 2; ++stage) {
        const double weight = (stage == 0 ? kExtrapolate : 1.0) * kGamma * size;
        forOverstress(rod, f.stages[stage].overstress, [&](const effects::MaxwellBranch& b, const Eigen::VectorXd& z) {
            f.relaxed += weight * b.stiffness / b.time * rod::bendingForm(rod.model, z);
        });
    }
    f.overstress = f.stages[1].overstress;
}

double acceptMaterial(Rod& rod, double dt, double damped, const FreeWork& f) {
    effects::RodEffects& fx = rod.effects;
    const double before = effects::taken(fx.energies);
    fx.material.age += dt;
    const double* overstress = f.overstress.data();
    for (std::vector<double>& branch : fx.material.overstress) {
        std::copy_n(overstress, branch.size(), branch.begin());
        overstress += branch.size();
    }
    effects::storedEnergy(rod.model, fx.material, rod.q, fx.energies);
    fx.energies[static_cast<std::size_t>(effects::Key::ViscoelasticBending)].dissipated += damped + f.relaxed;
    fx.energies[static_cast<std::size_t>(effects::Key::SofteningOverTime)].dissipated += f.softened;
    return effects::taken(fx.energies) - before;
}

} // namespace supercircle::step
