// The calls of a user of the bridge, on the port.

#include "bridge/box2d/box2d_port.h"

#include <memory>
#include <utility>

namespace supercircle::bridge {

Attachment attach(b2World& world, const Options& options) {
    auto port = std::make_shared<Box2dPort>(world, options);
    Box2dPort* const seen = port.get();
    return {std::move(port), seen};
}

void Attachment::set_name(const b2Body& body, const std::string& name) const {
    port_->setName(body, name);
}
std::uint64_t Attachment::body_id(const b2Body& body) const {
    return port_->idOf(body);
}
b2Body* Attachment::body(std::uint64_t id) const {
    return port_->bodyOf(id);
}
b2Fixture* Attachment::fixture(std::uint64_t body, std::uint32_t number) const {
    return port_->fixtureOf(body, number);
}
std::uint32_t Attachment::fixture_number(const b2Fixture& fixture) const {
    return Box2dPort::fixtureNumber(fixture);
}
void Attachment::notify_destroyed(const b2Body& body) const {
    port_->notifyDestroyed(body);
}
std::uint64_t Attachment::error_count() const {
    return port_->errorCount();
}
std::string Attachment::last_error() const {
    return port_->lastError();
}

} // namespace supercircle::bridge
