#include "plugin/shells/snapshot_fields.h"

#include <algorithm>
#include <cmath>

namespace supercircle {

using archive::Loader;

namespace {

/// One record of a log.
struct Record {
    Call call{};
    std::uint64_t inner = 0;
    std::vector<std::uint8_t> arguments;
};

/// Makes the calls of a log on other Shells.
class Replay {
public:
    Replay(Shells& shells, const std::function<bool(double)>& hostStep) : shells_(shells), hostStep_(hostStep) {}

    std::string run(const std::vector<Record>& records) {
        for (std::size_t i = 0; i < records.size() && !ended_; ++i) {
            const Record& r = records[i];
            fault_.clear();
            if (r.call == Call::PreStep)
                i = frame(records, i);
            else if (r.call == Call::PostStep)
                postStep();
            else
                make(r);
            if (!fault_.empty())
                return "record " + std::to_string(i) + " of the log: " + fault_;
        }
        return {};
    }

private:
    using Pair = std::pair<ShellHandle, ShellHandle>; ///< recorded, here

    ShellHandle here(const ShellHandle& recorded) const {
        const auto it =
            std::find_if(handles_.rbegin(), handles_.rend(), [&](const Pair& p) { return p.first == recorded; });
        return it != handles_.rend() ? it->second : ShellHandle{};
    }

    template <class... T>
    bool read(const Record& r, T&... x) {
        Loader in(r.arguments.data(), r.arguments.size());
        in(x...);
        if (in.fault().empty() && in.left() != 0)
            in.fail("it has arguments too many");
        fault_ = in.fault();
        return fault_.empty();
    }

    void expect(bool done) {
        if (!done)
            fault_ = "the call is refused here (is the host the same?)";
    }

    void make(const Record& r) {
        ShellHandle h, made;
        switch (r.call) {
        case Call::Restore:
            return restore(r);
        case Call::Create: {
            ShellDef d;
            if (!read(r, d, made))
                return;
            const Result<ShellHandle> here = shells_.create(d);
            expect(static_cast<bool>(here));
            if (here)
                handles_.emplace_back(made, *here);
            return;
        }
        case Call::Destroy:
            if (read(r, h))
                expect(static_cast<bool>(shells_.destroy(here(h))));
            return;
        case Call::Hold: {
            double fraction = 0.0;
            HoldKind kind{};
            bool onMachine = false;
            if (read(r, h, fraction, kind, onMachine))
                expect(static_cast<bool>(shells_.hold(here(h), fraction, kind, onMachine)));
            return;
        }
        case Call::Carry: {
            std::string name;
            if (read(r, name))
                expect(static_cast<bool>(shells_.carry(name)));
            return;
        }
        case Call::MachineVelocity: {
            Point v;
            if (read(r, v))
                shells_.set_machine_velocity(v);
            return;
        }
        case Call::SetName: {
            std::string name;
            if (read(r, h, name))
                expect(shells_.set_name(here(h), name));
            return;
        }
        case Call::SetUserData: {
            std::uint64_t data = 0;
            if (read(r, h, data))
                expect(shells_.set_user_data(here(h), data));
            return;
        }
        case Call::SetEventSettings: {
            EventSettings s;
            if (read(r, s))
                expect(static_cast<bool>(shells_.set_event_settings(s)));
            return;
        }
        case Call::SetQuality: {
            Quality quality{};
            if (read(r, quality))
                shells_.set_quality(quality);
            return;
        }
        default:
            fault_ = "it stands where it cannot be made";
            return;
        }
    }

    void restore(const Record& r) {
        std::vector<std::uint8_t> bytes;
        std::vector<ShellHandle> then;
        if (!read(r, bytes, then))
            return;
        const Result<Snapshot> state = Snapshot::from_bytes(std::move(bytes));
        if (!state) {
            fault_ = state.error();
            return;
        }
        const Outcome done = shells_.restore(*state);
        const std::vector<ShellHandle> now = shells_.list();
        if (!done || now.size() != then.size()) {
            fault_ = done ? "its handles do not fit its state" : done.error();
            return;
        }
        for (std::size_t i = 0; i < now.size(); ++i)
            handles_.emplace_back(then[i], now[i]);
    }

    /// A pre_step with the calls its observer made; returns the index of its end.
    std::size_t frame(const std::vector<Record>& records, std::size_t first) {
        std::size_t end = first + 1;
        while (end < records.size() && records[end].call != Call::FrameEnd)
            ++end;
        double dt = 0.0;
        std::uint64_t steps = 0;
        bool stopped = false;
        if (end == records.size())
            fault_ = "the frame has no end";
        else if (read(records[first], dt))
            read(records[end], steps, stopped);
        if (!fault_.empty())
            return end;
        std::size_t next = first + 1;
        std::uint64_t seen = 0;
        const FrameReport report = shells_.pre_step(dt, [&] {
            ++seen;
            for (; next < end && records[next].inner <= seen && fault_.empty(); ++next)
                make(records[next]);
            return stopped && seen == steps;
        });
        advanced_ = report.advanced;
        return end;
    }

    void postStep() {
        if (hostStep_ && !hostStep_(advanced_)) {
            ended_ = true;
            return;
        }
        shells_.post_step();
    }

    Shells& shells_;
    const std::function<bool(double)>& hostStep_;
    std::vector<Pair> handles_;
    double advanced_ = 0.0;
    bool ended_ = false;
    std::string fault_;
};

} // namespace

Outcome Shells::replay(const CallLog& log, const std::function<bool(double)>& host_step) {
    if (impl_->inside)
        return Outcome::failure("replay: not from within pre_step");
    const Result<CallLog> checked = CallLog::from_bytes(log.bytes()); // also of one that was never filled
    if (!checked)
        return Outcome::failure(checked.error());
    try {
        constexpr std::size_t kHeader = 8 + 4 + 8 + 8;
        Loader in(log.bytes().data() + kHeader, log.bytes().size() - kHeader);
        std::uint64_t seed = 0;
        in(seed);
        std::vector<Record> records;
        while (in.left() > 0 && in.fault().empty()) {
            records.emplace_back();
            in(records.back().call, records.back().inner, records.back().arguments);
        }
        if (std::string why = Replay(*this, host_step).run(records); !why.empty())
            return Outcome::failure(std::move(why));
    } catch (const std::exception& e) { // of the host, too
        return Outcome::failure(std::string("replay: ") + e.what());
    }
    return std::monostate{};
}

} // namespace supercircle
