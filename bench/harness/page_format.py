"""How the page and README write numbers: digits, units, tables."""
import html


def number(value, digits=3):
    if value is None:
        return "–"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, (list, tuple)):
        return ", ".join(number(each, digits) for each in value)
    if isinstance(value, dict):
        return ", ".join(f"{key}: {number(each, digits)}" for key, each in value.items())
    if not isinstance(value, (int, float)):
        return str(value)
    if isinstance(value, int) or (abs(value) >= 10**digits and abs(value) < 1e8):
        return f"{value:,.0f}".replace(",", "\u2009") if abs(value) >= 1e4 else f"{value:.0f}"
    return f"{value:.{digits}g}"


def seconds(value):
    if value is None:
        return "–"
    for size, unit in ((1, "s"), (1e-3, "ms"), (1e-6, "µs")):
        if value >= size:
            return f"{number(value / size)} {unit}"
    return f"{number(value / 1e-9)} ns"


def times(value):
    """A ratio to two digits."""
    if value is None:
        return "–"
    return number(float(f"{value:.2g}"))


def percent(value):
    return f"{number(value, 2)} %"


def share(value):
    """A fraction in per cent: 0.0181 is 1.8 %."""
    return percent(100 * value)


def in_norm(value):
    """100 |e| / |u| of 100 |e|^2 / |u|^2, which is what eqs. 16 and 17 print."""
    return percent(10 * value**0.5)


def root(value):
    """The ratio in the norm of a ratio of squared errors."""
    return number(value**0.5, 2)


def escape(text):
    return html.escape(str(text))


def table(rows, columns):
    """columns: (heading, function of a row); text longer than a number stands to the left."""
    out = ["<div class=wide><table><thead><tr>", *(f"<th>{escape(name)}</th>" for name, _ in columns), "</tr></thead><tbody>"]
    for row in rows:
        out.append("<tr>")
        for _, get in columns:
            cell = get(row)
            text = escape(cell if isinstance(cell, str) else number(cell))
            out.append(f"<td class=text>{text}</td>" if isinstance(cell, str) and len(cell) > 28 else f"<td>{text}</td>")
        out.append("</tr>")
    out.append("</tbody></table></div>")
    return "".join(out)


def between(values, show):
    low, high = show(min(values)), show(max(values))
    return low if low == high else f"{low} to {high}"
