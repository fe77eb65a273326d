#include "supercircle/rod/model.h"

#include "supercircle/support/elementary.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace supercircle::rod {

namespace {

/// Lengths that should be mirrored, or add up, may differ by this fraction of the rod's length.
constexpr double kLengthTolerance = 1e-9;
constexpr double kMinElement = 1e-6; ///< fraction of the rod's length

std::string checkLengths(const RodDefinition& d) {
    const std::size_t n = d.elementLength.size();
    if (n == 0)
        return {};
    if (n != d.naturalCurvature.size())
        return "element lengths need one value per element (" + std::to_string(d.naturalCurvature.size()) + ")";
    double sum = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
        if (!std::isfinite(d.elementLength[i]) || !(d.elementLength[i] >= kMinElement * d.length))
            return "element lengths must be finite and at least a millionth of the rod";
        if (std::abs(d.elementLength[i] - d.elementLength[n - 1 - i]) > kLengthTolerance * d.length)
            return "element lengths must be mirrored about the middle";
        sum += d.elementLength[i];
    }
    if (std::abs(sum - d.length) > kLengthTolerance * d.length)
        return "element lengths must add up to the length of the rod";
    return {};
}

} // namespace

int elementsMeetingAt(double fraction, int atLeast) {
    const auto mismatch = [&](int n) { return std::abs(fraction * n - std::round(fraction * n)) / n; };
    int best = atLeast;
    for (int n = atLeast + 1; n <= atLeast + 3; ++n)
        if (mismatch(n) < mismatch(best) - 1e-9)
            best = n;
    return best;
}

std::string validate(const RodDefinition& d) {
    const auto positive = [](double x) { return std::isfinite(x) && x > 0.0; };
    if (d.naturalCurvature.empty())
        return "a rod needs at least one element (natural curvature is empty)";
    if (!positive(d.length))
        return "length must be positive and finite";
    if (!positive(d.thickness))
        return "thickness must be positive and finite";
    if (!positive(d.linearMass))
        return "linear mass must be positive and finite";
    if (!positive(d.bendingModulus))
        return "bending modulus must be positive and finite";
    if (d.thickness >= d.length)
        return "thickness must be smaller than the length";
    for (double k : d.naturalCurvature)
        if (!std::isfinite(k))
            return "natural curvature must be finite";
    for (const PointMass& p : d.pointMasses) {
        if (!(p.s >= 0.0 && p.s <= d.length) || !(p.mass >= 0.0) || !std::isfinite(p.mass) || !(p.inertia >= 0.0))
            return "a point mass must lie on the rod, and neither mass nor inertia be negative or infinite";
        if (!(p.inertia <= p.mass * d.length * d.length))
            return "the radius of gyration of a point mass must not exceed the length of the rod";
    }
    return checkLengths(d);
}

double massOf(const RodDefinition& d) {
    double mass = d.linearMass * d.length;
    for (const PointMass& p : d.pointMasses)
        mass += p.mass;
    return mass;
}

std::vector<double> gradedLengths(double length, int elements, double tipRefinement) {
    const auto n = static_cast<std::size_t>(std::max(elements, 1));
    std::vector<double> lengths(n, length / static_cast<double>(n));
    if (elements <= 2 || tipRefinement == 1.0)
        return lengths;
    const int steps = (elements - 1) / 2; // from the middle element, or pair, to a tip
    double sum = 0.0;
    for (int i = 0; i < elements; ++i) {
        const int fromTip = std::min(i, elements - 1 - i);
        const double outward = 1.0 - static_cast<double>(fromTip) / steps;
        sum += lengths[static_cast<std::size_t>(i)] = math::pow(tipRefinement, -outward);
    }
    for (double& l : lengths)
        l *= length / sum;
    return lengths;
}

RodModel::RodModel(RodDefinition definition) : definition_(std::move(definition)) {
    elements_ = static_cast<int>(definition_.naturalCurvature.size());
    const int half = elements_ / 2;
    const double mid = midS();
    const bool odd = elements_ % 2 == 1;
    computeLengths();
    longest_ = *std::max_element(lengths_.begin(), lengths_.end());
    double turn = 0.0; // rad
    for (std::size_t i = 0; i < lengths_.size(); ++i)
        turn += std::abs(definition_.naturalCurvature[i]) * lengths_[i];
    radius_ = definition_.length / (turn >= 1.0 ? turn : 1.5 * M_PI);
    if (odd) {
        sides_[0].push_back({half, dofOfElement(half), mid, 0.5 * elementLength(half)});
        sides_[1].push_back({half, dofOfElement(half), mid, -0.5 * elementLength(half)});
    }
    for (int i = odd ? half + 1 : half; i < elements_; ++i)
        sides_[0].push_back({i, dofOfElement(i), nodeS(i), elementLength(i)});
    for (int i = half - 1; i >= 0; --i)
        sides_[1].push_back({i, dofOfElement(i), nodeS(i + 1), -elementLength(i)});
    mass_ = massOf(definition_);
    carryPointMasses();
}

/// An inertia is two halves of the mass at the radius of gyration before and behind the place, which turn with it:
/// kinetic energy m |u|^2 / 2 + J w^2 / 2 of the speed and the spin there, exactly.
void RodModel::carryPointMasses() {
    for (const PointMass& p : definition_.pointMasses) {
        const int which = p.s >= midS() ? 0 : 1;
        const std::vector<Segment>& list = sides_[which];
        std::size_t k = 0; // at a node the inner segment
        while (k + 1 < list.size() && std::abs(p.s - midS()) > std::abs(list[k + 1].innerS - midS()))
            ++k;
        const double local = p.s - list[k].innerS, radius = p.mass > 0.0 ? std::sqrt(p.inertia / p.mass) : 0.0;
        const int segment = static_cast<int>(k);
        if (radius > 0.0) {
            carried_.push_back({which, segment, local, radius, 0.5 * p.mass});
            carried_.push_back({which, segment, local, -radius, 0.5 * p.mass});
        } else if (p.mass > 0.0) {
            carried_.push_back({which, segment, local, 0.0, p.mass});
        }
    }
    if (carried_.empty())
        return;
    std::stable_sort(carried_.begin(), carried_.end(), [](const CarriedPoint& a, const CarriedPoint& b) {
        return a.side != b.side ? a.side < b.side : a.segment < b.segment;
    });
    const std::size_t segments = sides_[0].size() + sides_[1].size();
    firstCarried_.assign(segments + 1, 0);
    for (const CarriedPoint& c : carried_)
        ++firstCarried_[static_cast<std::size_t>(c.segment) + (c.side == 0 ? 0 : sides_[0].size()) + 1];
    for (std::size_t k = 0; k < segments; ++k)
        firstCarried_[k + 1] += firstCarried_[k];
}

void RodModel::computeLengths() {
    lengths_ = definition_.elementLength;
    equal_ = lengths_.empty();
    const auto n = static_cast<std::size_t>(elements_);
    if (equal_)
        lengths_.assign(n, definition_.length / elements_);
    nodeS_.resize(n + 1);
    if (equal_) {
        for (int i = 0; i <= elements_; ++i)
            nodeS_[static_cast<std::size_t>(i)] = i * lengths_.front();
        return;
    }
    // From the tips inwards, so that the two halves are bitwise mirror images and the middle is exact.
    const double scale = definition_.length / std::accumulate(lengths_.begin(), lengths_.end(), 0.0);
    nodeS_.front() = 0.0;
    nodeS_.back() = definition_.length;
    for (std::size_t i = 1; i <= n / 2; ++i) {
        lengths_[i - 1] *= scale;
        lengths_[n - i] = lengths_[i - 1];
        nodeS_[i] = nodeS_[i - 1] + lengths_[i - 1];
        nodeS_[n - i] = definition_.length - nodeS_[i];
    }
    if (n % 2 == 1)
        lengths_[n / 2] = nodeS_[n / 2 + 1] - nodeS_[n / 2];
    else
        nodeS_[n / 2] = midS();
}

int RodModel::elementAt(double s) const {
    if (equal_)
        return std::clamp(static_cast<int>(s / lengths_.front()), 0, elements_ - 1);
    const auto after = std::upper_bound(nodeS_.begin(), nodeS_.end(), s);
    return std::clamp(static_cast<int>(after - nodeS_.begin()) - 1, 0, elements_ - 1);
}

int RodModel::elementOfDof(int dof) const {
    const int half = elements_ / 2;
    if (elements_ % 2 == 0 || dof < half)
        return dof;
    return dof == elements_ - 1 ? half : dof + 1;
}

int RodModel::dofOfElement(int element) const {
    if (elements_ % 2 == 0)
        return element;
    const int half = elements_ / 2;
    if (element == half)
        return elements_ - 1;
    return element < half ? element : element - 1;
}

} // namespace supercircle::rod
