"""What came out of a sweep: one table, and pictures of it."""
import contextlib
import csv
import math
import os
import sys

HERE = os.path.dirname(os.path.realpath(__file__))
sys.path.insert(0, os.path.join(os.path.dirname(HERE), "scripts"))
from replays import DOUBTS, MEASURES
from whole_file import whole_file

SHOWN = [("peak_force_n", "peak force, N"), ("impulse_n_s", "impulse, N s"), ("contact_time_s", "time in contact, s"), ("likely_error_n", "likely error, N")]
TEXTS = ["key", "bag", "scene", "instrument", "sha256", "error"]
MOST_KEYS = 4  # of a picture: more is read from the table


def rows_of(study, keyed, results):
    """A row for each instrument of each variant; one without measures where a variant was refused."""
    for number, (key, variant) in enumerate(keyed):
        result = results[key]
        settings = dict(variant.settings)
        head = [number, key, os.path.basename(variant.bag), os.path.basename(variant.scene)] + [settings.get(name, "") for name in study.keys()]
        tail = ["%.4g" % result["cpu_time_s"], result.get("sha256", ""), result.get("error", "")]
        for instrument, measures in result.get("instruments", {}).items() or [("", {})]:
            yield head + [instrument] + [measures.get(name, "") for name in MEASURES] + tail


def columns(study):
    return ["variant", "key", "bag", "scene"] + study.keys() + ["instrument"] + MEASURES + ["cpu_time_s", "sha256", "error"]


def write_table(folder, study, keyed, results):
    """@return the files."""
    files = [os.path.join(folder, "table.csv")]
    with whole_file(files[0]) as part, open(part, "w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(columns(study))
        writer.writerows(rows_of(study, keyed, results))
    failed = [results[key]["error"] for key, _ in keyed if "error" in results[key]]
    if failed:
        print("sweep: %d variants were refused, the first: %s" % (len(failed), failed[0]))
    print(doubts_text(keyed, results), end="")
    return files + write_parquet(files[0], os.path.join(folder, "table.parquet"))


def doubts_text(keyed, results):
    """A line on variants whose forces are not all to be trusted; empty: there are none."""
    def is_in_doubt(key):
        return any(measures[name] for measures in results[key].get("instruments", {}).values() for name in DOUBTS)
    found = [number for number, (key, _) in enumerate(keyed) if is_in_doubt(key)]
    if not found:
        return ""
    return ("sweep: %d of %d variants have forces that are not to be trusted (columns %s of the table), the first: variant %d; see what the "
            "replay says of it\n" % (len(found), len(keyed), ", ".join(DOUBTS), found[0]))


def write_parquet(table, file):
    """Where pyarrow is; Debian 12 has none."""
    try:
        import pyarrow
        from pyarrow import csv as arrow_csv, parquet
    except ImportError as error:
        print("sweep: no table.parquet, which takes pyarrow: %s (Debian 12 has no package of it)" % error)
        with contextlib.suppress(FileNotFoundError):
            os.remove(file)  # of a table before this one
        return []
    texts = arrow_csv.ConvertOptions(column_types={name: pyarrow.string() for name in TEXTS})  # a hash may look like a number
    with whole_file(file) as part:
        parquet.write_table(arrow_csv.read_csv(table, convert_options=texts), part)
    return [file]


def number(text):
    try:
        value = float(text)
    except ValueError:
        return None
    return value if math.isfinite(value) else None


def numbers_of(study, keyed, results):
    """[(key, [its value in each row])] of keys whose values are all numbers, and the rows."""
    names = columns(study)
    rows = [dict(zip(names, row)) for row in rows_of(study, keyed, results) if row[names.index("instrument")]]
    keys = [(key, [number(row[key]) for row in rows]) for key in study.keys()]
    return [(key, values) for key, values in keys if values and None not in values and len(set(values)) > 1][:MOST_KEYS], rows


def write_pictures(folder, study, keyed, results):
    """Each measure over each key that was varied. @return the files."""
    keys, rows = numbers_of(study, keyed, results)
    if not keys:
        return []
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
    instruments = list(dict.fromkeys(row["instrument"] for row in rows))
    figure, axes = pyplot.subplots(len(SHOWN), len(keys), squeeze=False, sharex="col", sharey="row", figsize=(1.5 + 3.6 * len(keys), 1 + 2.1 * len(SHOWN)))
    for column, (key, values) in enumerate(keys):
        for line, (measure, label) in enumerate(SHOWN):
            plot_one(axes[line][column], instruments, rows, values, measure)
            if column == 0:
                axes[line][0].set_ylabel(label)
        if min(values) > 0 and max(values) > 20 * min(values):
            axes[0][column].set_xscale("log")
        axes[-1][column].set_xlabel("\n".join(key.rsplit(".", 1)))
    if len(instruments) > 1:
        axes[0][0].legend(fontsize="small", markerscale=3)
    figure.suptitle("%s: %d variants" % (os.path.basename(study.file), len(keyed)))
    figure.tight_layout()
    file = os.path.join(folder, "table.png")
    with whole_file(file) as part:
        figure.savefig(part, dpi=110, format="png")
    pyplot.close(figure)
    return [file]


def plot_one(axis, instruments, rows, values, measure):
    """Every variant as a dot; where a value occurs several times, the median of its variants as a line."""
    import numpy
    for instrument in instruments:
        points = [(value, row[measure]) for value, row in zip(values, rows) if row["instrument"] == instrument]
        x, y = numpy.array(points).T
        dots = axis.plot(x, y, ".", markersize=3 if len(x) < 1000 else 1, alpha=0.5, label=instrument)[0]
        different = numpy.unique(x)
        if 1 < len(different) <= len(x) / 2:
            axis.plot(different, [numpy.median(y[x == value]) for value in different], color=dots.get_color(), linewidth=1.2)
    axis.set_ylim(0, 1.05 * max(row[measure] for row in rows) or 1)
    axis.grid(alpha=0.3)
    if len(set(values)) > 2 and len(instruments) == 1:
        axis.set_title(rank_correlation(values, [row[measure] for row in rows]), loc="left", fontsize="x-small", pad=2)


def rank_correlation(values, measures):
    """Spearman's: 1 where a measure always grows with the value, 0 where it does not care."""
    if len(set(measures)) < 2:
        return ""
    from scipy.stats import spearmanr
    return "rank correlation %.2f" % spearmanr(values, measures)[0]
