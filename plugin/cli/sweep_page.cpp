#include "plugin/cli/sweep_page.h"

namespace supercircle::cli {

record::Result<std::vector<record::NamedText>> sweepPages(const sweep::Definition&, const sweep::Table&,
                                                          sweep::Store&) {
    return {};
}

} // namespace supercircle::cli
