#include "plugin/cli/diagnose_page.h"

namespace supercircle::cli {

std::string diagnosisPage(const diagnosis::Diagnosis& d, const experiment::Experiment&) {
    return "<!doctype html><html lang=\"en\"><title>" + d.verdict + "</title><p>" + d.statement + "</p></html>\n";
}

} // namespace supercircle::cli
