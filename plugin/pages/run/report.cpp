#include "plugin/pages/run/report.h"

#include <algorithm>
#include <array>
#include <exception>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <vector>

#include "plugin/graphics/cairo_canvas.h"
#include "plugin/graphics/theme.h"
#include "plugin/pages/run/figures.h"
#include "plugin/pages/run/run_page.h"
#include "plugin/recording/table/files.h"

namespace supercircle::pages {

using namespace graphics;

namespace {

using record::NamedText;
using record::Recording;

std::string titleOf(const Recording& recording, const std::string& what) {
    return recording.scene.empty() ? what : recording.scene + ": " + what;
}

/// Draws a picture and adds it if there was something to draw.
void addPicture(std::vector<NamedText>& files, const std::string& name, double width, double height, double scale,
                const std::function<bool(Canvas&)>& draw) {
    CairoCanvas canvas(width, height, scale);
    if (!draw(canvas))
        return;
    Result<std::string> png = canvas.png();
    if (!png)
        throw std::runtime_error(name + ": " + png.error());
    files.emplace_back(name, *std::move(png));
}

struct Views {
    std::vector<KeyView> keys;
    View view;
    double scale = 0.0;
};

Views viewsOf(const Recording& recording) {
    Views views{keyViews(recording), {}, largestBendingEnergy(recording)};
    std::vector<std::size_t> frames;
    for (const KeyView& key : views.keys)
        frames.push_back(key.frame);
    views.view = viewOf(recording, frames);
    return views;
}

void addConfigurations(std::vector<NamedText>& files, const Recording& recording, const Views& views) {
    const double height = std::clamp(576.0 * views.view.y.span() / views.view.x.span(), 160.0, 900.0) + 72.0;
    for (const KeyView& key : views.keys)
        addPicture(files, key.id + ".png", 600.0, height + 60.0, 2.0, [&](Canvas& canvas) {
            drawConfiguration(canvas, recording, key.frame, views.view, views.scale, {0.0, 0.0, 600.0, height},
                              key.title);
            if (views.scale > 0.0)
                drawColourBar(canvas, views.scale, {0.0, height + 2.0, 600.0, 56.0});
            return true;
        });
}

/// The configurations in a row above the curve.
void addOverview(std::vector<NamedText>& files, const Recording& recording, const Views& views) {
    const double width = 1200.0;
    const double each = views.keys.empty() ? width : std::min(width / static_cast<double>(views.keys.size()), 600.0);
    const double row = views.keys.empty()
                           ? 0.0
                           : std::clamp((each - 24.0) * views.view.y.span() / views.view.x.span(), 120.0, 620.0) + 72.0;
    const double bar = views.keys.empty() || views.scale <= 0.0 ? 0.0 : 58.0;
    const bool curve = hasForceCurve(recording), energy = recording.series.find("time_s") != nullptr;
    const double lower = curve || energy ? 540.0 : 0.0;
    if (row + lower <= 0.0)
        return;
    addPicture(files, "overview.png", width, row + bar + lower + 12.0, 4.0 / 3.0, [&](Canvas& canvas) {
        double x = 0.5 * (width - each * static_cast<double>(views.keys.size()));
        for (const KeyView& key : views.keys) {
            drawConfiguration(canvas, recording, key.frame, views.view, views.scale, {x, 4.0, each, row}, key.title);
            x += each;
        }
        if (bar > 0.0)
            drawColourBar(canvas, views.scale, {300.0, row + 4.0, 600.0, 56.0});
        const graphics::Rect sheet{40.0, row + bar + 8.0, width - 80.0, lower};
        const bool drawn =
            (curve ? drawForce(canvas, recording, sheet) : drawEnergy(canvas, recording, sheet)).has_value();
        return drawn || !views.keys.empty();
    });
}

std::vector<NamedText> draw(const Recording& recording) {
    std::vector<NamedText> files;
    addPicture(files, "force.png", 960.0, 600.0, 4.0 / 3.0, [&](Canvas& canvas) {
        return drawForce(canvas, recording, {0.0, 0.0, 960.0, 600.0}, titleOf(recording, "force against displacement"))
            .has_value();
    });
    addPicture(files, "energy.png", 960.0, 600.0, 4.0 / 3.0, [&](Canvas& canvas) {
        return drawEnergy(canvas, recording, {0.0, 0.0, 960.0, 600.0}, titleOf(recording, "energy balance"))
            .has_value();
    });
    const Views views = viewsOf(recording);
    addConfigurations(files, recording, views);
    addOverview(files, recording, views);
    files.emplace_back("report.html", runPage(recording));
    return files;
}

} // namespace

Result<std::vector<NamedText>> reportFiles(const Recording& recording) noexcept {
    using Files = Result<std::vector<NamedText>>;
    try {
        return Files(draw(recording));
    } catch (const std::exception& exception) {
        return Files::failure(std::string("cannot make the report: ") + exception.what());
    }
}

std::string removeOldReport(const std::string& directory, const std::vector<NamedText>& files) noexcept {
    try {
        for (const char* name : {"report.html", "force.png", "energy.png", "before.png", "peak.png", "after.png",
                                 "start.png", "end.png", "overview.png"}) {
            if (std::any_of(files.begin(), files.end(), [&](const NamedText& file) { return file.first == name; }))
                continue;
            std::error_code error;
            std::filesystem::remove(std::filesystem::path(directory) / name, error);
            if (error)
                return "cannot remove the old " + directory + "/" + name + ": " + error.message();
        }
        return {};
    } catch (const std::exception& exception) {
        return std::string("cannot remove the old report: ") + exception.what();
    }
}

std::string writeReport(const Recording& recording, const std::string& directory) noexcept {
    const auto files = reportFiles(recording);
    if (!files)
        return files.error();
    const std::string error = record::writeAtomically(directory, *files).error();
    return error.empty() ? removeOldReport(directory, *files) : error;
}

} // namespace supercircle::pages
