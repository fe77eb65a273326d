// Handles of the library to those of C and back.

#include "bridge/c/world.h"

namespace supercircle::c {

namespace {

template <class T, class Handle, class F>
T named(Names<Handle>& names, const Handle& h, F&& alive) {
    if (h.null())
        return {0};
    const std::uint64_t id = names.idOf(h, alive);
    if (id == 0)
        refuse(SC_REFUSED, "there are a million handles of this kind already");
    return {id};
}

template <class Handle>
Handle found(Names<Handle>& names, std::uint64_t id, const Shells& shells, const char* what) {
    const Handle* h = names.find(id);
    if (h == nullptr || !shells.valid(*h))
        refuse(SC_STALE, std::string("the ") + what + " handle is " +
                             (id == 0 ? "null" : "stale: it was destroyed, or belongs to another world"));
    return *h;
}

} // namespace

sc_shell World::out(const ShellHandle& h) {
    return named<sc_shell>(shellNames, h, [&](const ShellHandle& v) { return shells.valid(v); });
}
sc_hold World::out(const HoldHandle& h) {
    return named<sc_hold>(holdNames, h, [&](const HoldHandle& v) { return shells.valid(v); });
}
sc_joint World::out(const JointHandle& h) {
    return named<sc_joint>(jointNames, h, [&](const JointHandle& v) { return shells.valid(v); });
}
sc_force World::out(const ForceHandle& h) {
    return named<sc_force>(forceNames, h, [&](const ForceHandle& v) { return shells.valid(v); });
}
sc_body World::outBody(BodyId body) {
    if (body == 0)
        return {0};
    return {bodyNames.idOf(body, [&](BodyId v) { return attachment.body(v) != nullptr; })};
}

ShellHandle World::in(sc_shell s) {
    return found(shellNames, s.id, shells, "shell");
}
HoldHandle World::in(sc_hold h) {
    return found(holdNames, h.id, shells, "hold");
}
JointHandle World::in(sc_joint j) {
    return found(jointNames, j.id, shells, "joint");
}
ForceHandle World::in(sc_force f) {
    return found(forceNames, f.id, shells, "force");
}

BodyId World::idOf(sc_body b) {
    const BodyId* body = bodyNames.find(b.id);
    if (body == nullptr || attachment.body(*body) == nullptr)
        refuse(SC_STALE, std::string("the body handle is ") +
                             (b.id == 0 ? "null" : "stale: it was destroyed, or belongs to another world"));
    return *body;
}
b2Body& World::in(sc_body b) {
    return *attachment.body(idOf(b));
}

void World::requireUnlocked() const {
    if (box2d->IsLocked())
        refuse(SC_REFUSED, "the host's world is inside its step: call this before or after it");
}

} // namespace supercircle::c
