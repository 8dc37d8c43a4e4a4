"""Prints each channel of a ULog as pyulog reads it, as JSON: name, and number, lowest and highest of its finite values."""

import json
import sys

import numpy as np
from pyulog import ULog


def main():
    out = {}
    for data in ULog(sys.argv[1]).data_list:
        name = data.name + (f".{data.multi_id}" if data.multi_id else "")
        for field, values in data.data.items():
            values = np.asarray(values, dtype=float)
            values = values[np.isfinite(values)]
            if field != "timestamp" and len(values):
                out[f"{name}/{field}"] = [len(values), values.min(), values.max()]
    print(json.dumps(out))


main()
