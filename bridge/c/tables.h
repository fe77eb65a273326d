#pragma once
// Handles of the C interface: 12 bits world, 20 bits index, 32 bits generation. Generations come from one counter of
// the process: a handle of another kind, of another world or of something destroyed fits no slot.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <unordered_map>
#include <utility>
#include <vector>

namespace supercircle::c {

inline constexpr std::uint32_t kMostWorlds = 4096;
inline constexpr std::uint32_t kMostObjects = 1U << 20; ///< of a kind and world

/// Never 0, and not given out twice within four thousand million.
std::uint32_t nextGeneration() noexcept;

inline std::uint32_t worldSlot(std::uint64_t id) noexcept {
    return static_cast<std::uint32_t>(id >> 52);
}
inline std::uint32_t objectIndex(std::uint64_t id) noexcept {
    return static_cast<std::uint32_t>(id >> 32) & (kMostObjects - 1);
}
inline std::uint32_t generationOf(std::uint64_t id) noexcept {
    return static_cast<std::uint32_t>(id);
}
inline std::uint64_t makeId(std::uint32_t world, std::uint32_t index, std::uint32_t generation) noexcept {
    return std::uint64_t{world} << 52 | std::uint64_t{index} << 32 | generation;
}

/// Objects of one kind in one world.
template <class T>
class Table {
public:
    explicit Table(std::uint32_t world) : world_(world) {}

    /// 0 when the table is full.
    std::uint64_t add(T value) {
        std::uint32_t index = static_cast<std::uint32_t>(slots_.size());
        if (!free_.empty()) {
            index = free_.back();
            free_.pop_back();
        } else if (index < kMostObjects) {
            slots_.emplace_back();
        } else {
            return 0;
        }
        Slot& slot = slots_[index];
        slot.value = std::move(value);
        slot.generation = nextGeneration();
        return makeId(world_, index, slot.generation);
    }
    /// Null if the handle is stale.
    [[nodiscard]] T* find(std::uint64_t id) {
        const std::uint32_t index = objectIndex(id);
        if (worldSlot(id) != world_ || index >= slots_.size() || generationOf(id) == 0 ||
            slots_[index].generation != generationOf(id))
            return nullptr;
        return &slots_[index].value;
    }
    void remove(std::uint64_t id) {
        if (find(id) == nullptr)
            return;
        free_.reserve(slots_.size());
        slots_[objectIndex(id)] = {};
        free_.push_back(objectIndex(id));
    }
    /// Calls `visit(id, value)` for each; true removes it.
    template <class F>
    void sweep(F&& visit) {
        for (std::uint32_t i = 0; i < slots_.size(); ++i) {
            const std::uint64_t id = makeId(world_, i, slots_[i].generation);
            if (slots_[i].generation != 0 && visit(id, slots_[i].value))
                remove(id);
        }
    }
    [[nodiscard]] std::size_t size() const { return slots_.size() - free_.size(); }
    [[nodiscard]] std::uint32_t world() const { return world_; }

private:
    struct Slot {
        T value{};
        std::uint32_t generation = 0;
    };
    std::uint32_t world_;
    std::vector<Slot> slots_;
    std::vector<std::uint32_t> free_;
};

/// A table whose objects are named by the library: the same object has the same handle. Objects that the library has
/// destroyed are swept out when the table has doubled.
template <class T>
class Names {
public:
    explicit Names(std::uint32_t world) : table_(world) {}

    /// The handle of an object, 0 when the table is full. `alive(value)` tells whether the library still has it.
    template <class F>
    std::uint64_t idOf(const T& value, F&& alive) {
        if (const auto known = ids_.find(value); known != ids_.end())
            return known->second;
        if (table_.size() >= sweepAt_) {
            table_.sweep([&](std::uint64_t, const T& v) {
                const bool dead = !alive(v);
                if (dead)
                    ids_.erase(v);
                return dead;
            });
            sweepAt_ = 2 * table_.size() + 64;
        }
        const std::uint64_t id = table_.add(value);
        if (id != 0)
            ids_.emplace(value, id);
        return id;
    }
    [[nodiscard]] T* find(std::uint64_t id) { return table_.find(id); }

private:
    struct Hash {
        std::size_t operator()(std::uint64_t value) const { return std::hash<std::uint64_t>()(value); }
        template <class Handle>
        std::size_t operator()(const Handle& h) const {
            return (*this)((std::uint64_t{h.index} << 32 | h.generation) ^ std::uint64_t{h.world} << 48);
        }
    };
    Table<T> table_;
    std::unordered_map<T, std::uint64_t, Hash> ids_;
    std::size_t sweepAt_ = 64;
};

} // namespace supercircle::c
