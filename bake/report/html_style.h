// This style sheet says how the report looks, light and dark.
#pragma once

namespace sunbeam {

inline constexpr const char* kHtmlStyle = R"(:root {
  color-scheme: light dark;
  --page: #f6f6f4; --panel: #ffffff; --text: #1d1f23; --faint: #666b74; --edge: #e2e2de;
  --pass: #1f8a4c; --fail: #c93434;
}
@media (prefers-color-scheme: dark) {
  :root { --page: #131417; --panel: #1c1e22; --text: #e6e7ea; --faint: #9aa0aa; --edge: #2d3037; }
}
body { margin: 0; background: var(--page); color: var(--text); font: 15px/1.5 system-ui, sans-serif; }
main { max-width: 1120px; margin: 0 auto; padding: 32px 24px 64px; }
header, section { margin-bottom: 44px; }
h1 { margin: 8px 0 0; font-size: 30px; overflow-wrap: anywhere; }
h2 { margin: 0 0 4px; font-size: 20px; }
section > p, .lead { max-width: 76ch; margin: 0 0 16px; color: var(--faint); }
.badge { display: inline-block; margin: 0; padding: 2px 14px; border-radius: 99px; color: #fff; font-weight: 700; }
.pass { background: var(--pass); }
.fail { background: var(--fail); }
.cards { display: grid; grid-template-columns: repeat(auto-fit, minmax(160px, 1fr)); gap: 12px; margin-bottom: 16px; }
.card { display: flex; flex-direction: column; padding: 12px 16px; background: var(--panel);
  border: 1px solid var(--edge); border-radius: 10px; }
.card span, .card small, figcaption { color: var(--faint); font-size: 13px; }
.card data { font-size: 24px; font-weight: 600; font-variant-numeric: tabular-nums; }
.grid { display: flex; flex-wrap: wrap; gap: 14px; }
figure { margin: 0; width: fit-content; box-sizing: border-box; max-width: 100%; padding: 12px; background: var(--panel); border: 1px solid var(--edge); border-radius: 10px; }
figcaption { margin-top: 8px; text-align: center; }
#slices figcaption, #spheres figcaption, #worst figcaption { width: 0; min-width: 100%; }
svg { max-width: 100%; height: auto; display: block; }
img { display: block; max-width: 100%; height: auto; border-radius: 4px; }
.trio { display: flex; gap: 2px; }
.wide { overflow-x: auto; margin-bottom: 14px; }
table { border-collapse: collapse; font-size: 13px; font-variant-numeric: tabular-nums; }
th, td { padding: 5px 12px; border-bottom: 1px solid var(--edge); text-align: right; font-weight: 400; }
th { color: var(--faint); }
.keys th, .keys td { text-align: left; }
pre { padding: 12px 16px; overflow-x: auto; background: var(--panel); border: 1px solid var(--edge);
  border-radius: 10px; font-size: 13px; }
summary { cursor: pointer; padding: 6px 0; }
)";

}  // namespace sunbeam
