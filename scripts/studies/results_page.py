"""One table of results: results.json and index.html in a folder. For make verify and make hard."""
import html
import json
import os

STYLE = """body{font:15px/1.35 sans-serif;margin:2em auto;max-width:110em;padding:0 1em}table{border-collapse:collapse}
th{text-align:left;position:sticky;top:0;background:#fff}td,th{padding:.15em .8em .15em 0;vertical-align:top;border-top:1px solid #ddd}td{max-width:34em;overflow-wrap:anywhere}
.group td{padding-top:1.2em;font-weight:bold}.fail td{color:#b00;font-weight:bold}.skip td{color:#777}.group td{max-width:none}.threat{color:#555;font-weight:normal}img{max-width:100%}"""


def show(value):
    if value is None:
        return ""
    return f"{value:.6g}" if isinstance(value, float) else html.escape(str(value))


def count(results):
    return {s: sum(r["status"] == s for r in results) for s in ("pass", "fail", "skip")}


def write(folder, title, results, columns, note=""):
    """columns: (key, heading). Prints what is not green; returns the number of failures."""
    os.makedirs(folder, exist_ok=True)
    with open(os.path.join(folder, "results.json"), "w") as file:
        json.dump(results, file, indent=1)
    n = count(results)
    rows, last = "", None
    for r in results:
        if r.get("group", last) != last:  # a line of its own for what rows share
            last = r["group"]
            rows += f"<tr class=group><td colspan={len(columns)}>{html.escape(last)}</td></tr>\n"
        rows += f"<tr class={r['status']}>" + "".join(
            f"<td{' class=threat' if key in ('threat', 'why') else ''}>{show(r.get(key))}</td>" for key, _ in columns) + "</tr>\n"
    plots = "".join(f"<p><img src='{name}'></p>" for name in sorted(os.listdir(folder)) if name.endswith(".svg"))
    with open(os.path.join(folder, "index.html"), "w") as file:
        file.write(f"<!doctype html><meta charset=utf-8><title>Tosui: {title}</title><style>{STYLE}</style><h1>{title}</h1>{note}"
                   f"<p>{n['pass']} pass, {n['fail']} fail, {n['skip']} skip.</p>{plots}<table><tr>"
                   + "".join(f"<th>{heading}" for _, heading in columns) + f"</tr>\n{rows}</table>")
    for r in results:
        if r["status"] != "pass":
            print(f"{r['status']}: {r['case']}: reference {show(r['reference'])}, measured {show(r['measured'])}, bound {show(r['bound'])}")
    print(f"{os.path.join(folder, 'index.html')}\n{n['pass']} passed, {n['fail']} failed, {n['skip']} skipped")
    return n["fail"]
