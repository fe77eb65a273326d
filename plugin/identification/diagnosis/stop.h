#pragma once
// When a diagnosis ends before its time: the user's interrupt, which ends everything, and a time limit, which ends what
// can be left out.

#include <atomic>
#include <functional>
#include <utility>

namespace supercircle::diagnosis {

/// Thrown where work ends early. What was found before stays valid.
struct Stopped {};

/// Asked by every loop, from any thread.
class StopToken {
public:
    /// @param interrupt becomes true: everything ends; null: never
    /// @param late whether the time limit is over; empty: there is none
    explicit StopToken(const std::atomic<bool>* interrupt = nullptr, std::function<bool()> late = {})
        : interrupt_(interrupt), late_(std::move(late)) {}

    [[nodiscard]] bool late() const { return late_ && late_(); }
    [[nodiscard]] bool interrupted() const { return interrupt_ != nullptr && interrupt_->load(); }
    [[nodiscard]] bool stopped() const {
        const bool over = late(); // asked first, so that each question is counted
        return interrupted() || (over && heeded_);
    }
    /// Throws Stopped. Not inside a parallel loop.
    void poll() const {
        if (stopped())
            throw Stopped{};
    }
    [[nodiscard]] const std::atomic<bool>* interrupt() const { return interrupt_; }

    /// The time limit counts, or does not, while this lives.
    class Heed {
    public:
        Heed(const StopToken& token, bool heeded) : token_(token), before_(token.heeded_.exchange(heeded)) {}
        ~Heed() { token_.heeded_ = before_; }
        Heed(const Heed&) = delete;
        Heed& operator=(const Heed&) = delete;

    private:
        const StopToken& token_;
        bool before_;
    };

    /// Work that a verdict can do without: false if the time limit has ended it. An interrupt goes on.
    template <class Work>
    bool attempt(const Work& work) const {
        const Heed heed(*this, true);
        try {
            poll();
            work();
            return true;
        } catch (const Stopped&) {
            if (interrupted())
                throw;
            return false;
        }
    }

private:
    const std::atomic<bool>* interrupt_;
    std::function<bool()> late_;
    mutable std::atomic<bool> heeded_{false};
};

} // namespace supercircle::diagnosis
