#include "plugin/cli/data_folders.h"

#include "plugin/scene/loader/shipped.h"

namespace supercircle::cli {

std::string scenesFolder() {
    return scene::shippedFolder();
}

std::string referenceFolder() {
    return scene::dataFolder("reference", SC_REFERENCE_DIR);
}

} // namespace supercircle::cli
