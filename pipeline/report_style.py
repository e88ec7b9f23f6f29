# SPDX-License-Identifier: GPL-3.0-or-later
"""How the report looks: light, dark, on a narrow screen and on paper."""

from __future__ import annotations

STYLE = """
:root { color-scheme: light dark; --ink: #23282e; --soft: #636d78; --line: #dfe3e7; --paper: #fff; --wash: #f4f5f6;
  --accent: #2f6f8f; --second: #b36a2e; --kept: #eaf3f7; --good: #2e7d4f; --warn: #8f6200; --bad: #b3352b;
  --good-wash: #e5f2ea; --warn-wash: #fbf1da; --bad-wash: #f9e4e2; }
@media (prefers-color-scheme: dark) { :root { --ink: #e4e7ea; --soft: #9aa4ae; --line: #363c43; --paper: #1c2024;
  --wash: #15181b; --accent: #6fb3d3; --second: #dd9c66; --kept: #22323b; --good: #7cc79b; --warn: #e0b65c; --bad: #e88a80;
  --good-wash: #1f3428; --warn-wash: #3a3018; --bad-wash: #40231f; } }
* { box-sizing: border-box; }
html { background: var(--wash); }
body { margin: 0 auto; max-width: 1120px; padding: 40px 48px 64px; background: var(--paper); color: var(--ink);
  font: 15px/1.5 system-ui, "Segoe UI", Roboto, "Helvetica Neue", "DejaVu Sans", sans-serif; }
h1 { font-size: 28px; font-weight: 600; line-height: 1.25; margin: 0; overflow-wrap: anywhere; }
h2 { font-size: 19px; font-weight: 600; margin: 46px 0 10px; padding-bottom: 6px; border-bottom: 1px solid var(--line); }
h3 { font-size: 15px; font-weight: 600; margin: 22px 0 6px; }
p { margin: 6px 0; max-width: 75ch; }
.lead { color: var(--soft); margin-top: 2px; }
.answered { color: var(--soft); margin: 18px 0 0; max-width: none; }
nav { margin: 16px 0 0; display: flex; flex-wrap: wrap; gap: 4px 18px; font-size: 14px; }
a { color: var(--accent); text-decoration: none; } a:hover { text-decoration: underline; }
dl.facts { display: grid; grid-template-columns: repeat(auto-fill, minmax(165px, 1fr)); gap: 16px 24px; margin: 26px 0 0; }
dl.facts dt { color: var(--soft); font-size: 13px; }
dl.facts dd { margin: 0; font-size: 17px; font-variant-numeric: tabular-nums; overflow-wrap: anywhere; }
dl.facts small { display: block; color: var(--soft); font-size: 13px; }
.pictures { display: grid; grid-template-columns: repeat(2, minmax(0, 1fr)); gap: 20px; margin-top: 26px; align-items: start; }
figure { margin: 0; }
figure img { display: block; width: 100%; height: auto; max-height: 560px; object-fit: contain; background: var(--wash);
  border-radius: 6px; }
.pictures.more { grid-template-columns: repeat(3, minmax(0, 1fr)); } .pictures:empty { display: none; }
.pictures.more img { aspect-ratio: 4 / 3; }
figcaption { color: var(--soft); font-size: 13px; margin-top: 5px; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; font-size: 14px; }
th { text-align: left; font-weight: 600; color: var(--soft); font-size: 13px; vertical-align: bottom; }
th, td { padding: 6px 14px 6px 0; border-bottom: 1px solid var(--line); vertical-align: top; }
td.text { overflow-wrap: anywhere; min-width: 130px; }
th.number, td.number { text-align: right; white-space: nowrap; }
td:first-child { white-space: nowrap; }
tr.sum td { font-weight: 600; border-bottom: 0; }
tr.kept td { background: var(--kept); }
.chip { display: inline-block; padding: 0 8px; border-radius: 9px; font-size: 12.5px; line-height: 19px;
  background: var(--wash); color: var(--soft); white-space: nowrap; }
.chip.placed, .chip.detailed, .chip.picture { background: var(--good-wash); color: var(--good); }
.chip.deferred { background: var(--warn-wash); color: var(--warn); }
.chip.dropped { background: var(--bad-wash); color: var(--bad); }
.chip.model { background: var(--kept); color: var(--accent); }
.bar { display: inline-block; width: 46px; height: 6px; border-radius: 3px; background: var(--line); margin-right: 7px;
  vertical-align: 2px; overflow: hidden; print-color-adjust: exact; }
.bar i { display: block; height: 100%; background: var(--accent); print-color-adjust: exact; }
.measure { white-space: nowrap; } .measure .bar { width: 30px; margin-right: 5px; }
.swatch { display: inline-block; width: 14px; height: 14px; border-radius: 3px; vertical-align: -2px; margin-right: 6px;
  box-shadow: inset 0 0 0 1px rgba(128, 128, 128, .4); print-color-adjust: exact; }
.looks { display: grid; grid-template-columns: repeat(auto-fill, minmax(190px, 1fr)); gap: 10px 18px; margin: 14px 0; }
.look { display: flex; align-items: center; gap: 11px; min-width: 0; }
.look .swatch { flex: none; width: 42px; height: 42px; border-radius: 6px; margin: 0; }
.look div { min-width: 0; line-height: 1.35; font-size: 14px; overflow-wrap: anywhere; }
.look small { display: block; color: var(--soft); font-size: 12.5px; }
.parts span { display: inline-block; margin: 0 14px 2px 0; white-space: nowrap; }
.textures { display: grid; grid-template-columns: repeat(auto-fill, minmax(235px, 1fr)); gap: 22px; margin: 16px 0; }
.texture img, .texture .none { width: 100%; height: 150px; object-fit: cover; max-height: none; border-radius: 6px; display: block;
  background: var(--wash); }
.texture .chip { white-space: normal; }
.texture p { margin: 6px 0 0; font-size: 14px; } .texture small { display: block; color: var(--soft); font-size: 13px; }
details { margin: 10px 0; } summary { cursor: pointer; color: var(--accent); }
.plots { display: grid; grid-template-columns: minmax(0, 1.5fr) minmax(0, 1fr); gap: 10px 36px; align-items: center; margin: 14px 0 20px; }
.plots.single { grid-template-columns: minmax(0, 1fr); }
svg { display: block; width: 100%; height: auto; overflow: visible; font: 12px system-ui, "Segoe UI", "DejaVu Sans", sans-serif; }
svg text { fill: var(--soft); } svg text.strong { fill: var(--ink); font-weight: 600; }
svg .grid { stroke: var(--line); stroke-width: 1; } svg .line { fill: none; stroke: var(--accent); stroke-width: 2.5; }
svg .other { fill: none; stroke: var(--second); stroke-width: 1.5; stroke-dasharray: 5 4; }
svg text.accent { fill: var(--accent); font-weight: 600; } svg text.second { fill: var(--second); }
svg .dot { fill: var(--paper); stroke: var(--accent); stroke-width: 2.5; } svg .dot.kept { fill: var(--accent); }
.small { display: grid; grid-template-columns: repeat(2, minmax(0, 1fr)); gap: 10px 22px; }
.small > div { display: grid; grid-template-columns: 62px minmax(0, 1fr); gap: 10px; align-items: center; font-size: 13px;
  line-height: 1.3; }
.small small { display: block; color: var(--soft); }
ul { margin: 4px 0 10px; padding-left: 20px; } li { margin: 2px 0; overflow-wrap: anywhere; }
code { font: 13px ui-monospace, "SF Mono", Consolas, "DejaVu Sans Mono", monospace; }
.error h3 { color: var(--bad); } .warning h3 { color: var(--warn); }
.quiet { color: var(--soft); }
footer { margin-top: 52px; color: var(--soft); font-size: 13px; }
@media (max-width: 760px) { body { padding: 22px 16px; } .pictures, .pictures.more, .plots { grid-template-columns: 1fr; } }
@media print { :root { color-scheme: light; --ink: #23282e; --soft: #636d78; --line: #dfe3e7; --paper: #fff; --wash: #f4f5f6;
  --accent: #2f6f8f; --second: #b36a2e; --kept: #eaf3f7; } html { background: none; }
  body { max-width: none; padding: 0; font-size: 11pt; } nav { display: none; }
  figure img { max-height: 85mm; } h2, h3 { break-after: avoid; } tr, figure, li, .look, .texture { break-inside: avoid; }
  .chip, tr.kept td { print-color-adjust: exact; } @page { margin: 16mm; } }
"""
