//! All plots and tables on one page that needs nothing from elsewhere.

use std::fmt::Write;

use super::{Report, Row, svg};

const HEAD: &str = r#"<!doctype html><html lang="en"><meta charset="utf-8"><meta name="viewport" content="width=device-width,initial-scale=1">
<title>Calipers: what accuracy costs</title><style>
:root{color-scheme:light dark}body{font:15px/1.5 system-ui,sans-serif;max-width:96rem;margin:2rem auto;padding:0 1rem;background:#fff;color:#222}
.plots{display:grid;grid-template-columns:repeat(auto-fill,minmax(min(34rem,100%),1fr));gap:1rem}figure{margin:0;border:1px solid #8884;border-radius:8px;padding:.6rem}
svg{width:100%;height:auto}figure .plot text{fill:currentColor}circle{cursor:help}circle:hover{stroke:currentColor;stroke-width:2}table{border-collapse:collapse;font-size:13px}
td,th{padding:.15rem .6rem;text-align:right;border-bottom:1px solid #8883}td:nth-child(-n+3),th:nth-child(-n+3){text-align:left}.wide{overflow-x:auto}
code{font-size:12px}#tip{position:fixed;display:none;max-width:26rem;padding:.4rem .6rem;border-radius:6px;background:#222;color:#fff;font-size:13px;pointer-events:none}
.lie{color:#c0392b;white-space:pre-wrap}@media(prefers-color-scheme:dark){body{background:#16181c;color:#ddd}#tip{background:#eee;color:#111}}
</style><h1>What accuracy costs</h1>
<p>Each point is a setting: how long half of the questions take at most (across), and how far the worst answer was from the truth (up), both
logarithmic. The dashed line joins the settings that no other beats in both. Rest the pointer on a point to read its setting and the request
that asks for it. Times are those of the machine that made this page.</p>
"#;

const TAIL: &str = r#"<div id="tip"></div><script>
const tip=document.getElementById('tip');
for(const c of document.querySelectorAll('circle')){const t=c.querySelector('title');if(!t)continue;const text=t.textContent;
c.setAttribute('aria-label',text);t.remove();
c.addEventListener('pointermove',e=>{tip.textContent=text;tip.style.display='block';
tip.style.left=Math.min(e.clientX+14,innerWidth-tip.offsetWidth-8)+'px';tip.style.top=Math.min(e.clientY+14,innerHeight-tip.offsetHeight-8)+'px'});
c.addEventListener('pointerleave',()=>tip.style.display='none')}
</script></html>
"#;

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;")
}

/// The page of some reports.
#[must_use]
pub fn page(reports: &[Report]) -> String {
    let mut out = HEAD.to_owned();
    for report in reports {
        let _ = write!(out, "<h2>{}</h2>", escaped(&report.scene));
        let audited = report.audited.iter().map(|it| format!("{} {} of {}", it.kind.text(), it.judged, it.answers));
        let _ = write!(
            out,
            "<p>The truth is what the exact tier proves. The oracle, which shares nothing with it, was asked about some of its answers: {}.</p>",
            audited.collect::<Vec<_>>().join(", ")
        );
        for lie in &report.lies {
            let _ = write!(out, "<p class=\"lie\">{} {}: {}</p>", lie.kind.text(), lie.number, escaped(&lie.sentence));
        }
        let kinds: Vec<_> = report.audited.iter().map(|audited| audited.kind).collect();
        out.push_str("<div class=\"plots\">");
        for kind in &kinds {
            let rows: Vec<&Row> = report.rows.iter().filter(|row| row.kind == *kind).collect();
            let _ = write!(out, "<figure>{}</figure>", svg(&rows));
        }
        out.push_str("</div>");
        numbers(&mut out, &report.rows);
    }
    out.push_str(TAIL);
    out
}

fn numbers(out: &mut String, rows: &[Row]) {
    out.push_str("<details><summary>All numbers</summary><div class=\"wide\"><table><tr>");
    for name in [
        "question",
        "knob",
        "setting",
        "p50 ns",
        "p99 ns",
        "iterations",
        "nodes",
        "pairs",
        "error p50 m",
        "error p99 m",
        "error max m",
        "width max m",
        "open",
        "stood in",
        "held",
    ] {
        let _ = write!(out, "<th>{name}</th>");
    }
    out.push_str("</tr>");
    for row in rows {
        let _ =
            write!(out, "<tr><td>{}</td><td>{}</td><td>{}</td>", row.kind.text(), row.knob.text(), escaped(&row.label));
        let [_, half, most] = row.time_ns;
        let _ = write!(out, "<td>{half:.0}</td><td>{most:.0}</td>");
        row.work[..3].iter().for_each(|work| out.push_str(&format!("<td>{work:.1}</td>")));
        let lengths = row.error.into_iter().chain([row.width[2]]);
        lengths.for_each(|length| out.push_str(&format!("<td>{length:.1e}</td>")));
        let shares = [row.open, row.stood_in, row.held as f64 / row.count.max(1) as f64];
        shares.iter().for_each(|share| out.push_str(&format!("<td>{:.0} %</td>", share * 100.0)));
        out.push_str("</tr>");
    }
    out.push_str("</table></div></details>");
}
