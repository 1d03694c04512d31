#!/usr/bin/env python3
"""One job on Spark, for `vesalius train --on script:examples/cluster/spark_job.py` (docs/cluster.md).

SPARK_MASTER names the cluster; without it two tasks at a time run on this machine, each tried four times.
"""

import os
import re
import sys
import zlib

from pyspark import SparkConf, SparkContext

settings = SparkConf().setAppName(os.environ["VESALIUS_JOB"]).setMaster(os.environ.get("SPARK_MASTER", "local[2,4]"))
settings.set("spark.ui.enabled", "false").set("spark.task.cpus", os.environ["VESALIUS_TASK_THREADS"])
map_tasks, reduce_tasks = int(os.environ["VESALIUS_MAP_TASKS"]), int(os.environ["VESALIUS_REDUCE_TASKS"])
with open(sys.argv[1], encoding="ascii") as file:
    lines = file.read().splitlines()
try:
    with SparkContext(conf=settings) as spark:
        records = spark.parallelize(lines, map_tasks).pipe(os.environ["VESALIUS_MAP"], dict(os.environ), checkCode=True)
        if reduce_tasks > 0:
            records = (records.map(lambda record: tuple(record.split("\t", 1)))
                       .repartitionAndSortWithinPartitions(reduce_tasks, lambda key: zlib.crc32(key.encode()))
                       .map("\t".join)
                       .pipe(os.environ["VESALIUS_REDUCE"], dict(os.environ), checkCode=True))
        records.saveAsTextFile("file://" + sys.argv[2])
except Exception as error:  # the cause is far down in what Spark says
    sys.exit((re.findall(r"^(?:: )?([\w.]*(?:Error|Exception): .*)", str(error), re.MULTILINE) or [str(error)])[-1])
