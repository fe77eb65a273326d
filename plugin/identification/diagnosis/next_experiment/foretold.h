#pragma once
// A run that was not made, as rivals foretell it: what each reads, and how that changes with what is open in them.
//
// What several runs tell together needs of each only the products of these changes with each other and with what two
// rivals read apart (Foretold::products()), which add up. So any two of ten runs, made up to eight times between them,
// are compared without another simulation.

#include "plugin/identification/diagnosis/evaluator.h"
#include "plugin/identification/diagnosis/fit.h"
#include "plugin/identification/diagnosis/next_experiment/sight.h"
#include "plugin/identification/diagnosis/noise.h"

#include <Eigen/Core>
#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace supercircle::diagnosis {

/// A model in question, as it was fitted.
struct Rival {
    std::string label;
    Point point;
    Eigen::VectorXd x;
    Eigen::MatrixXd covariance; ///< posteriorOf()
    double weight = 1.0;        ///< how probable it is; of one without effects ("nothing") it does not count
    bool otherSide = false;     ///< the mirror image of another one, which it is no part of
};

/// What is open in rivals, one list for all of them: the nominal parameters, which do much the same in all (moved in
/// the first), then each rival's own numbers.
class Open {
public:
    Open(const Model& model, const std::vector<Rival>& rivals);

    struct Number {
        std::size_t rival = 0;
        Eigen::Index number = 0; ///< in the rival's x
    };
    [[nodiscard]] const std::vector<Number>& numbers() const { return numbers_; }
    [[nodiscard]] Eigen::Index size() const { return static_cast<Eigen::Index>(numbers_.size()); }
    /// How a rival's x deviates: a column each of what one deviation changes in it.
    [[nodiscard]] const Eigen::MatrixXd& factor(std::size_t rival) const { return factor_[rival]; }
    /// The same by numbers().
    [[nodiscard]] const Eigen::MatrixXd& deviations(std::size_t rival) const { return deviations_[rival]; }

private:
    std::vector<Number> numbers_;
    std::vector<Eigen::MatrixXd> factor_, deviations_;
};

class Foretold {
public:
    /// All of them outlive it.
    Foretold(Evaluator& evaluator, std::size_t index, const Design& design, const Noise& noise, double zeroWindow,
             const std::vector<Rival>& rivals, const Open& open)
        : evaluator_(evaluator), index_(index), design_(design), noise_(noise), zeroWindow_(zeroWindow),
          rivals_(rivals), open_(open) {}

    /// False if it cannot be simulated.
    bool simulate();
    /// By all that is open; until then rivals stay as they are, which refutes more than there is. Once is enough.
    void differentiate();
    /// With other numbers.
    [[nodiscard]] std::vector<DesignResponse> at(const std::vector<Point>& points) const {
        return evaluator_.foretell(index_, points);
    }

    /// Readings as they are compared where one rival is true, of one repeat of so many.
    [[nodiscard]] std::unique_ptr<Sight> sightOf(std::size_t is, std::size_t repeats) const;
    /// Of what a rival that is true reads, minus a response; of all repeats together, in noise units. Empty: they
    /// cannot be compared.
    [[nodiscard]] Eigen::VectorXd apart(const Sight& sight, std::size_t repeats, std::size_t is,
                                        const DesignResponse& said) const;
    [[nodiscard]] Eigen::VectorXd apart(const Sight& sight, std::size_t repeats, std::size_t is,
                                        std::size_t said) const {
        return apart(sight, repeats, is, responses_[said]);
    }
    /// A column for each open number, likewise; zero where it cannot be simulated. No rows: nothing is open.
    [[nodiscard]] Eigen::MatrixXd changes(const Sight& sight, std::size_t repeats) const;
    /// Where one rival is true: [changes, apart from each rival]' [the same]. Rivals that cannot be compared are not
    /// apart.
    const Eigen::MatrixXd& products(std::size_t is, std::size_t repeats);

    [[nodiscard]] const Design& design() const { return design_; }

private:
    /// The run with one open number of its rival moved.
    struct Moved {
        double step = 0.0; ///< of x
        DesignResponse response;
    };
    [[nodiscard]] bool usable(const DesignResponse& r) const;

    Evaluator& evaluator_;
    std::size_t index_;
    const Design& design_;
    const Noise& noise_;
    double zeroWindow_;
    const std::vector<Rival>& rivals_;
    const Open& open_;
    std::vector<DesignResponse> responses_; ///< of the rivals
    std::vector<Moved> moved_;              ///< by open_.numbers()
    std::map<std::pair<std::size_t, std::size_t>, Eigen::MatrixXd> products_;
};

} // namespace supercircle::diagnosis
