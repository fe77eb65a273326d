#include "plugin/graphics/page_parts.h"

namespace supercircle::report {

std::string_view pageStyle() {
    return R"css(
:root { color-scheme: light; --ink: #1b1f24; --muted: #57606a; --line: #dfe3e8; --paper: #fff; --ground: #f5f6f8;
  --accent: #2a6fb8; --warm: #c8452d; }
* { box-sizing: border-box; }
body { margin: 0; background: var(--ground); color: var(--ink);
  font: 15px/1.5 system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", Arial, sans-serif; }
svg text { font-family: inherit; }
main { max-width: 1280px; margin: 0 auto; padding: 28px 24px 48px; }
header h1 { margin: 0 0 4px; font-size: 28px; line-height: 1.2; letter-spacing: -0.01em; overflow-wrap: anywhere; }
header p { margin: 0 0 4px; max-width: 76ch; }
header .about { color: var(--muted); }
h2 { margin: 0 0 10px; font-size: 17px; }
section { background: var(--paper); border: 1px solid var(--line); border-radius: 10px; padding: 18px 20px;
  min-width: 0; }
.grid { display: grid; gap: 18px; margin-top: 18px; grid-template-columns: minmax(0, 1fr); }
@media (min-width: 1040px) {
  .pair { grid-template-columns: minmax(0, 9fr) minmax(0, 11fr); }
  .halves { grid-template-columns: minmax(0, 1fr) minmax(0, 1fr); align-items: start; }
}
.grid .grid { margin-top: 0; }
.tiles { display: flex; flex-wrap: wrap; gap: 12px; margin-top: 18px; }
.tile { flex: 1 1 150px; background: var(--paper); border: 1px solid var(--line); border-radius: 10px;
  padding: 12px 16px; }
.tile b { display: block; font-size: 24px; font-weight: 600; line-height: 1.25; font-variant-numeric: tabular-nums;
  white-space: nowrap; }
.tile b small { font-size: 14px; font-weight: 400; color: var(--muted); }
.tile span { color: var(--muted); font-size: 13px; }
.scroll { overflow-x: auto; }
.scroll > svg { display: block; width: 100%; height: auto; min-width: 560px; }
.wide > svg { min-width: 760px; }
.views { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(270px, 100%), 1fr)); gap: 8px 16px; }
.views svg, .bar svg { display: block; width: 100%; height: auto; }
.views > div { max-width: 620px; }
.bar { max-width: 560px; margin: 12px auto 0; }
#stage { display: block; width: 100%; touch-action: pan-y; background: #fbfbfc; border: 1px solid var(--line);
  border-radius: 8px; }
.controls { display: flex; flex-wrap: wrap; align-items: center; gap: 8px; margin-top: 10px; }
.controls input[type=range] { flex: 1 1 160px; min-width: 120px; accent-color: var(--accent); }
.controls label { display: inline-flex; align-items: center; gap: 5px; font-size: 13px; color: var(--muted);
  white-space: nowrap; }
button, select { font: inherit; font-size: 14px; color: var(--ink); background: var(--paper);
  border: 1px solid #c6ccd3;
  border-radius: 7px; padding: 4px 10px; min-height: 32px; }
button:hover, select:hover { border-color: #8c959f; }
button:focus-visible, select:focus-visible, input:focus-visible { outline: 2px solid var(--accent);
  outline-offset: 1px; }
#play { min-width: 82px; background: var(--accent); border-color: var(--accent); color: #fff; font-weight: 600; }
.readout { display: grid; grid-template-columns: repeat(auto-fit, minmax(84px, 1fr)); gap: 2px 10px;
  margin: 10px 0 0; }
.readout div { white-space: nowrap; }
.readout dt { font-size: 12px; color: var(--muted); }
.readout dd { margin: 0; font-variant-numeric: tabular-nums; }
.key { display: flex; flex-wrap: wrap; align-items: center; gap: 4px 10px; font-size: 12px; color: var(--muted);
  margin-top: 8px; }
.key i { display: inline-block; width: 120px; height: 9px; border-radius: 2px; }
.key [hidden] { display: none; }
.hint { color: var(--muted); font-size: 12.5px; margin: 8px 0 0; }
kbd { font: 11.5px ui-monospace, Menlo, Consolas, monospace; border: 1px solid var(--line); border-radius: 4px;
  padding: 0 4px; background: var(--ground); }
table { border-collapse: collapse; width: 100%; font-size: 14px; font-variant-numeric: tabular-nums; }
th { text-align: left; font-weight: 600; font-size: 12.5px; color: var(--muted); border-bottom: 1px solid #c6ccd3;
  padding: 4px 10px 4px 0; }
td { border-bottom: 1px solid #edf0f2; padding: 5px 10px 5px 0; vertical-align: top; }
tr:last-child td { border-bottom: 0; }
th.n, td.n { text-align: right; white-space: nowrap; }
td.k { white-space: nowrap; }
td.u { color: var(--muted); white-space: nowrap; }
td code { font: 12px ui-monospace, Menlo, Consolas, monospace; color: var(--muted); overflow-wrap: anywhere; }
tr[data-time] { cursor: pointer; }
tr[data-time]:hover td { background: #f3f7fc; }
.long { max-height: 460px; overflow: auto; }
footer { color: var(--muted); font-size: 12.5px; margin-top: 18px; }
@media (max-width: 640px) {
  main { padding: 16px 10px 32px; }
  section { padding: 14px 12px; }
  td code, th.code { display: none; }
}
@media print { section { break-inside: avoid; } .controls { display: none; } }
)css";
}

} // namespace supercircle::report
