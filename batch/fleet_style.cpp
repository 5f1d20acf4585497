#include "batch/fleet_style.h"

namespace hookeye {

// Colours as the report has them (studio/src/style.css).
const char* const kFleetStyle = R"(
:root { --paper: #ffffff; --stage: #f2f3f5; --ink: #1b1f24; --soft: #545c66; --line: #d4d8dd;
  --accent: #0b5cad; --bar: #3b7dbd; --mark: #b2182b; --good: #1a6b3c; --warn: #8a4b00;
  color-scheme: light dark; }
@media (prefers-color-scheme: dark) { :root { --paper: #14171b; --stage: #1d2127; --ink: #e8eaed;
  --soft: #aab2bc; --line: #3a414a; --accent: #7db8f2; --bar: #5b9bd8; --mark: #ff8a80;
  --good: #7bd49d; --warn: #f1b96a; } }
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 1320px; padding: 14px 20px 40px; background: var(--paper);
  color: var(--ink); font: 14px/1.4 system-ui, 'Segoe UI', Roboto, 'DejaVu Sans', sans-serif; }
h1 { font-size: 19px; margin: 0 0 2px; }
h2 { font-size: 15px; margin: 0 0 8px; }
h3 { font-size: 14px; margin: 0; }
h3 small, .soft { color: var(--soft); font-weight: 400; }
a { color: var(--accent); text-decoration: none; }
a:hover { text-decoration: underline; }
:focus-visible { outline: 2px solid var(--accent); outline-offset: 1px; }
.counts { display: flex; flex-wrap: wrap; gap: 4px 22px; margin: 8px 0 14px; padding: 0;
  list-style: none; }
.counts b { font-size: 22px; font-variant-numeric: tabular-nums; margin-right: 5px; }
.counts .failed b { color: var(--mark); }
.counts .explained b { color: var(--good); }
.counts .doubt b { color: var(--warn); }
section { border-top: 1px solid var(--line); padding: 14px 0 18px; }
.effects { display: grid; gap: 3px; max-width: 900px; }
.effects details, .effects .all { border-radius: 5px; }
summary { display: grid; grid-template-columns: 190px 1fr 76px; gap: 10px; align-items: center;
  cursor: pointer; padding: 2px 4px; border-radius: 5px; list-style: none; }
summary::-webkit-details-marker { display: none; }
summary:hover { background: var(--stage); }
summary .name { overflow: hidden; text-overflow: ellipsis; white-space: nowrap; }
summary .number { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
summary svg { width: 100%; height: 14px; display: block; }
details p { margin: 2px 4px 8px 204px; font-size: 13px; }
.track { fill: var(--stage); }
.fill { fill: var(--bar); }
.fill.tied { fill-opacity: 0.45; }
.fill.none { fill: var(--good); }
.fill.untold { fill: var(--warn); }
.plots { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 520px), 1fr));
  gap: 20px 34px; align-items: start; }
.plots > div { min-width: 0; }
.plots p { margin: 0 0 4px; font-size: 13px; color: var(--soft); }
svg.strip { width: 100%; display: block; overflow: hidden; }
svg.strip text { font-size: 11px; fill: var(--soft); }
svg.strip text.far { fill: var(--mark); }
.grid { stroke: var(--line); }
.median { stroke: var(--soft); stroke-dasharray: 3 3; }
.whisker { stroke: var(--bar); stroke-width: 1.6; stroke-opacity: 0.6; }
.dot { fill: var(--bar); }
.whisker.open { stroke: var(--warn); }
.dot.open { fill: var(--paper); stroke: var(--warn); stroke-width: 1.5; }
.whisker.far { stroke: var(--mark); }
.dot.far { fill: var(--mark); }
.hit { fill: transparent; }
a:hover .hit, g:hover > .hit { fill: var(--stage); }
.wide { overflow-x: auto; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; }
th, td { text-align: left; padding: 3px 12px 3px 0; vertical-align: top; font-weight: 400;
  border-bottom: 1px solid var(--line); }
th { color: var(--soft); white-space: nowrap; }
td.value { text-align: right; white-space: nowrap; }
th.value { text-align: right; }
td.line { overflow-wrap: anywhere; min-width: 240px; }
.explained { color: var(--good); }
.doubt { color: var(--warn); }
.failed { color: var(--mark); }
code { font: 12.5px ui-monospace, 'DejaVu Sans Mono', monospace; }
footer { color: var(--soft); font-size: 13px; border-top: 1px solid var(--line); padding-top: 8px; }
@media (max-width: 640px) { body { padding: 10px 12px 30px; }
  summary { grid-template-columns: 118px 1fr 62px; gap: 6px; } details p { margin-left: 4px; } }
)";

const char* const kFleetStyleHash = "tK0xMLPB6mvRQBYdKYEO1+rBIJacE1W+diw659TVIgc=";

}  // namespace hookeye
