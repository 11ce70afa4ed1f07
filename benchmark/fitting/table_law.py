#!/usr/bin/python3
"""A power law through measured coefficients of friction over pressure: mu = A (p / 10 kPa)^n from 3 kPa on, with intervals by bootstrap over loads, and
how well every second load predicts the others. doc/calibration.md has its figures.

  benchmark/fitting/table_law.py pla_on_silicone_friction.csv    (from github.com/tolstoys19/Friction-Measurements-Between-PLA-and-Silicone)
"""
import argparse
import csv

import numpy

MATERIAL, FROM_PA, RESAMPLES = "Nanotribometer DragonSkin10", 3000.0, 10000


def medians(path):
    """(pressures (Pa), median coefficient of each, rounds in all)."""
    by_pressure = {}
    with open(path, newline="", encoding="utf-8") as stream:
        for row in csv.DictReader(stream):
            if row["DataName"] == MATERIAL:
                by_pressure.setdefault(1000.0 * float(row["H.pressure"]), []).append(float(row["CoF.mean"]))
    pressures = numpy.array(sorted(by_pressure))
    return pressures, numpy.array([numpy.median(by_pressure[p]) for p in pressures]), sum(map(len, by_pressure.values()))


def fit(pressures, coefficients):
    """(n, log A)."""
    return numpy.polyfit(numpy.log(pressures / 1e4), numpy.log(coefficients), 1)


def predict(law, pressures):
    return numpy.exp(numpy.polyval(law, numpy.log(pressures / 1e4)))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("table")
    pressures, coefficients, rounds = medians(parser.parse_args().table)
    print("%d rounds at %d loads" % (rounds, len(pressures)))
    used = pressures >= FROM_PA
    p, mu = pressures[used], coefficients[used]
    law = fit(p, mu)
    generator = numpy.random.default_rng(1)
    drawn = numpy.array([fit(p[rows], mu[rows]) for rows in generator.integers(0, len(p), (RESAMPLES, len(p)))])
    low, high = numpy.quantile(drawn, [0.025, 0.975], axis=0)
    print("%d loads from %g Pa: mu = %.3f (p / 10 kPa)^%.3f; 95 %%: %.3f to %.3f, exponent %.3f to %.3f; RMS about it %.1f %%" % (
        len(p), FROM_PA, numpy.exp(law[1]), law[0], numpy.exp(low[1]), numpy.exp(high[1]), low[0], high[0],
        100.0 * numpy.sqrt(((predict(law, p) / mu - 1.0) ** 2).mean())))
    wrong = numpy.abs(predict(fit(p[::2], mu[::2]), p[1::2]) / mu[1::2] - 1.0)
    print("every second load predicts the others within %.1f %% (median), %.1f %% (largest)" % (100.0 * numpy.median(wrong), 100.0 * wrong.max()))


if __name__ == "__main__":
    main()
