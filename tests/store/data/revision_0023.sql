BEGIN TRANSACTION;
CREATE TABLE alembic_version (
	version_num VARCHAR(32) NOT NULL, 
	CONSTRAINT alembic_version_pkc PRIMARY KEY (version_num)
);
INSERT INTO "alembic_version" VALUES('0023');
CREATE TABLE attempts (
	run_seq INTEGER NOT NULL, 
	number INTEGER NOT NULL, 
	owner_id VARCHAR(40) NOT NULL, 
	worker VARCHAR(100) NOT NULL, 
	claimed_at DATETIME NOT NULL, 
	started_at DATETIME, 
	ended_at DATETIME, 
	outcome VARCHAR(24) NOT NULL, 
	cause VARCHAR(40) NOT NULL, 
	signal VARCHAR(16) NOT NULL, 
	log TEXT NOT NULL, 
	CONSTRAINT pk_attempts PRIMARY KEY (run_seq, number), 
	CONSTRAINT fk_attempts_run_seq_runs FOREIGN KEY(run_seq) REFERENCES runs (seq) ON DELETE CASCADE, 
	CONSTRAINT fk_attempts_owner_id_owners FOREIGN KEY(owner_id) REFERENCES owners (id)
);
INSERT INTO "attempts" VALUES(1,1,'01a227df782d4fb20e34d336','slot-0','2026-11-29 15:14:46.740244','2026-11-29 15:14:46.747496','2026-11-29 15:14:46.747496','finished','','','');
INSERT INTO "attempts" VALUES(2,1,'01a227df782d4fb20e34d336','slot-0','2026-11-29 15:14:46.740244','2026-11-29 15:14:46.747518','2026-11-29 15:14:46.747518','finished','','','');
INSERT INTO "attempts" VALUES(3,1,'01a227df782d4fb20e34d336','','2026-11-29 15:14:46.740244',NULL,NULL,'','','','');
INSERT INTO "attempts" VALUES(4,1,'01a227df782d4fb20e34d336','slot-0','2026-11-29 15:14:46.752697','2026-11-29 15:14:46.754037','2026-11-29 15:14:46.754037','simulator_crashed','signal','SIGSEGV','last line');
INSERT INTO "attempts" VALUES(5,1,'01a227df782d4fb20e34d336','slot-0','2026-11-29 15:14:46.752697','2026-11-29 15:14:46.764254','2026-11-29 15:14:46.764254','finished','','','');
INSERT INTO "attempts" VALUES(6,1,'01a227df782d4fb20e34d336','slot-0','2026-11-29 15:14:46.752697','2026-11-29 15:14:46.764269','2026-11-29 15:14:46.764269','infrastructure_failed','worker_lost','','');
INSERT INTO "attempts" VALUES(7,1,'01a227df782d4fb20e34d336','slot-0','2026-11-29 15:14:46.752697','2026-11-29 15:14:46.765936','2026-11-29 15:14:46.765936','finished','','','');
INSERT INTO "attempts" VALUES(8,1,'01a227df782d4fb20e34d336','slot-0','2026-11-29 15:14:46.752697','2026-11-29 15:14:46.765950','2026-11-29 15:14:46.765950','finished','','','');
INSERT INTO "attempts" VALUES(9,1,'01a227df782d4fb20e34d336','slot-0','2026-11-29 15:14:46.752697','2026-11-29 15:14:46.765958','2026-11-29 15:14:46.765958','finished','','','');
INSERT INTO "attempts" VALUES(10,1,'01a227df782d4fb20e34d336','slot-0','2026-11-29 15:14:46.752697','2026-11-29 15:14:46.765967','2026-11-29 15:14:46.765967','finished','','','');
INSERT INTO "attempts" VALUES(11,1,'01a227df782d4fb20e34d336','','2026-11-29 15:14:46.752697',NULL,NULL,'','','','');
INSERT INTO "attempts" VALUES(12,1,'01a227df782d4fb20e34d336','','2026-11-29 15:14:46.752697',NULL,NULL,'','','','');
INSERT INTO "attempts" VALUES(4,2,'01a227df782d4fb20e34d336','slot-0','2026-11-29 15:14:46.755603','2026-11-29 15:14:46.756647','2026-11-29 15:14:46.756647','simulator_crashed','signal','SIGSEGV','last line');
INSERT INTO "attempts" VALUES(6,2,'01a227df782d4fb20e34d336','','2026-11-29 15:14:46.801345',NULL,NULL,'','','','');
CREATE TABLE batch_facets (
	batch_seq INTEGER NOT NULL, 
	facet BIGINT NOT NULL, 
	runs INTEGER NOT NULL, 
	CONSTRAINT pk_batch_facets PRIMARY KEY (batch_seq, facet), 
	CONSTRAINT fk_batch_facets_batch_seq_batches FOREIGN KEY(batch_seq) REFERENCES batches (seq) ON DELETE CASCADE
);
INSERT INTO "batch_facets" VALUES(1,2723149239750009280,0);
INSERT INTO "batch_facets" VALUES(2,2723149239750009280,0);
INSERT INTO "batch_facets" VALUES(3,2723149239750009280,1);
INSERT INTO "batch_facets" VALUES(3,4027394518245958855,1);
INSERT INTO "batch_facets" VALUES(4,2723149239750009280,0);
INSERT INTO "batch_facets" VALUES(4,4027394518245958855,0);
INSERT INTO "batch_facets" VALUES(4,727384556823528832,1);
INSERT INTO "batch_facets" VALUES(4,2422866546981553484,1);
INSERT INTO "batch_facets" VALUES(1,9189786221799453301,1);
INSERT INTO "batch_facets" VALUES(1,6402252806136511734,1);
INSERT INTO "batch_facets" VALUES(1,8463407477753882159,1);
INSERT INTO "batch_facets" VALUES(2,9189786221799453301,3);
INSERT INTO "batch_facets" VALUES(2,1126162244662291354,1);
INSERT INTO "batch_facets" VALUES(2,6402252806136511734,1);
INSERT INTO "batch_facets" VALUES(2,8463407477753882159,4);
INSERT INTO "batch_facets" VALUES(1,1126162244662291354,1);
CREATE TABLE batches (
	seq INTEGER NOT NULL, 
	id VARCHAR(40) NOT NULL, 
	name VARCHAR(200) NOT NULL, 
	priority INTEGER NOT NULL, 
	state VARCHAR(16) NOT NULL, 
	created_at DATETIME NOT NULL, 
	size INTEGER NOT NULL, 
	queued INTEGER NOT NULL, 
	served INTEGER NOT NULL, 
	owner_id VARCHAR(40) DEFAULT '' NOT NULL, 
	revision INTEGER DEFAULT 0 NOT NULL, 
	CONSTRAINT pk_batches PRIMARY KEY (seq), 
	CONSTRAINT uq_batches_id UNIQUE (id)
);
INSERT INTO "batches" VALUES(1,'jobs','jobs posted alone',0,'open','2026-11-29 15:14:46.494576',4,0,3,'',64);
INSERT INTO "batches" VALUES(2,'01a227df7905e8d117fa58d0','batch',1,'open','2026-11-29 15:14:46.661450',9,0,11,'',68);
INSERT INTO "batches" VALUES(3,'01a227df79105c50dc434f4d','paused',2,'paused','2026-11-29 15:14:46.672310',2,2,0,'',25);
INSERT INTO "batches" VALUES(4,'01a227df79122458a39778f4','cancelled',2,'cancelled','2026-11-29 15:14:46.674532',2,0,0,'',28);
CREATE TABLE campaigns (
	seq INTEGER NOT NULL, 
	id VARCHAR(40) NOT NULL, 
	name VARCHAR(200) NOT NULL, 
	document TEXT NOT NULL, 
	tester VARCHAR(64) NOT NULL, 
	agent VARCHAR(200) NOT NULL, 
	configuration VARCHAR(400) DEFAULT '' NOT NULL, 
	configuration_id VARCHAR(8) DEFAULT '' NOT NULL, 
	town VARCHAR(100) NOT NULL, 
	network_sha256 VARCHAR(64) NOT NULL, 
	budget INTEGER NOT NULL, 
	versions TEXT NOT NULL, 
	state VARCHAR(16) NOT NULL, 
	message TEXT NOT NULL, 
	request VARCHAR(16) NOT NULL, 
	batch_id VARCHAR(40) DEFAULT '' NOT NULL, 
	claim VARCHAR(40) DEFAULT '' NOT NULL, 
	created_at DATETIME NOT NULL, 
	started_at DATETIME, 
	ended_at DATETIME, 
	updated_at DATETIME NOT NULL, 
	active_s DOUBLE NOT NULL, 
	evaluations INTEGER NOT NULL, 
	judged INTEGER NOT NULL, 
	invalid INTEGER NOT NULL, 
	failed INTEGER NOT NULL, 
	violating INTEGER NOT NULL, 
	at_fault INTEGER NOT NULL, 
	avoidable INTEGER, 
	unavoidable INTEGER, 
	undetermined INTEGER, 
	preventable INTEGER, 
	agent_failed INTEGER, 
	not_at_fault INTEGER, 
	best TEXT DEFAULT '{}' NOT NULL, 
	study_id VARCHAR(40) DEFAULT '' NOT NULL, 
	study_scenario VARCHAR(100) DEFAULT '' NOT NULL, 
	study_agent VARCHAR(100) DEFAULT '' NOT NULL, 
	study_method VARCHAR(100) DEFAULT '' NOT NULL, 
	repetition INTEGER DEFAULT 0 NOT NULL, 
	revision INTEGER DEFAULT 0 NOT NULL, 
	seed_runs TEXT DEFAULT '[]' NOT NULL, 
	CONSTRAINT pk_campaigns PRIMARY KEY (seq), 
	CONSTRAINT uq_campaigns_id UNIQUE (id)
);
INSERT INTO "campaigns" VALUES(1,'01a227df799b0a3666c37b8c','search','{"name":"search"}','random','idm','idm','','tee-town','aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa',10,'{"numpy": "2"}','finished','','','','','2026-11-29 15:14:46.811954','2026-11-29 15:14:46.824373','2026-11-29 15:14:46.878072','2026-11-29 15:14:46.878072',5.0,6,4,1,1,3,2,2,0,0,0,0,1,'{}','','','','',0,79,'[]');
INSERT INTO "campaigns" VALUES(2,'01a227df79a461f39b484459','waiting','{"name":"search"}','random','idm','idm','','tee-town','aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa',10,'{"numpy": "2"}','queued','','','','','2026-11-29 15:14:46.820234',NULL,NULL,'2026-11-29 15:14:46.820234',0.0,0,0,0,0,0,0,0,0,0,0,0,0,'{}','','','','',0,70,'[]');
CREATE TABLE change_epochs (
	seq INTEGER NOT NULL, 
	id VARCHAR(16) NOT NULL, 
	last INTEGER NOT NULL, 
	CONSTRAINT pk_change_epochs PRIMARY KEY (seq), 
	CONSTRAINT uq_change_epochs_id UNIQUE (id)
);
INSERT INTO "change_epochs" VALUES(1,'e87bec82d481',0);
INSERT INTO "change_epochs" VALUES(2,'277a2f9b15c3',0);
INSERT INTO "change_epochs" VALUES(3,'d05f03cd19b7',79);
CREATE TABLE documents (
	sha256 VARCHAR(64) NOT NULL, 
	body TEXT NOT NULL, 
	CONSTRAINT pk_documents PRIMARY KEY (sha256)
);
INSERT INTO "documents" VALUES('a00644508de97e85263c9d0cd67e63d3c3b5d733bcaddc65b110e501ad5a7b73','{0}');
INSERT INTO "documents" VALUES('cd80994abb0d1e0465acdc560717676578c1774f461babbe67b4b131497a6305','{1}');
INSERT INTO "documents" VALUES('f5e1420e13fd6cca6b2b875d53d06576439e4afec75fcc4a98d7b3b69b10b17e','{2}');
INSERT INTO "documents" VALUES('c7401b91208af75ed9bdf943e87800172f9871b7662e0d30952e12ce41432b42','{3}');
INSERT INTO "documents" VALUES('79bc9b3597a171a403b40fdc3ce66d411aa88ffdf527e2766465408430cfda51','{4}');
INSERT INTO "documents" VALUES('caf8b22a0011849577800b93050eeca10cca7b856c90bcc5b2200ce21ed1ec22','{5}');
INSERT INTO "documents" VALUES('bcd69d66128edb57808dbd5522ef9f1a82acc53a5211bf8936ab7e90e501afb4','{6}');
INSERT INTO "documents" VALUES('d56a5b5f9f0826672864fbd0f06a3c4b221a1be6350097ba49eb555128767fda','{7}');
INSERT INTO "documents" VALUES('8ffab84f301293229d1be75efb0dca213eb538579de22b842b941f7363090616','{8}');
INSERT INTO "documents" VALUES('0f2a693e93e2ed7008feb5b7714bbab236e3907e64188199e3be1ae367f49c40','grid');
INSERT INTO "documents" VALUES('5feceb66ffc86f38d952786c6d696c79c2dbc239dd4e91b46729d73a27fb57e9','0');
INSERT INTO "documents" VALUES('d4735e3a265e16eee03f59718b9b5d03019c07d8b6c51f90da3a666eec13ab35','2');
INSERT INTO "documents" VALUES('4e07408562bedb8b60ce05c1decfe3ad16b72230967de01f640b7e4729b49fce','3');
INSERT INTO "documents" VALUES('4b227777d4dd1fc61c6f884f48641d02b4d121d3fd328cb08b5531fcacdabf8a','4');
INSERT INTO "documents" VALUES('ef2d127de37b942baad06145e54b0c619a1f22327b2ebbcfbec78f5564afe39d','5');
CREATE TABLE evaluations (
	campaign_seq INTEGER NOT NULL, 
	number INTEGER NOT NULL, 
	generation INTEGER NOT NULL, 
	origin VARCHAR(60) NOT NULL, 
	parents TEXT NOT NULL, 
	genes TEXT NOT NULL, 
	status VARCHAR(16) NOT NULL, 
	document_sha256 VARCHAR(64), 
	violations INTEGER NOT NULL, 
	at_fault_violations INTEGER NOT NULL, 
	accountability VARCHAR(16), 
	sim_time_s DOUBLE NOT NULL, 
	wall_time_s DOUBLE NOT NULL, 
	search_s DOUBLE NOT NULL, 
	prepare_s DOUBLE NOT NULL, 
	asked_sha256 VARCHAR(64), 
	seed_number INTEGER DEFAULT 0 NOT NULL, 
	redrawn INTEGER DEFAULT 0 NOT NULL, 
	told_at DATETIME NOT NULL, 
	report TEXT NOT NULL, 
	violating BOOLEAN DEFAULT 0 NOT NULL, 
	CONSTRAINT pk_evaluations PRIMARY KEY (campaign_seq, number), 
	CONSTRAINT fk_evaluations_campaign_seq_campaigns FOREIGN KEY(campaign_seq) REFERENCES campaigns (seq) ON DELETE CASCADE, 
	CONSTRAINT fk_evaluations_document_sha256_documents FOREIGN KEY(document_sha256) REFERENCES documents (sha256)
);
INSERT INTO "evaluations" VALUES(1,0,0,'initial','[]','[0.0, 0.3333333333333333, -1e-17]','judged','5feceb66ffc86f38d952786c6d696c79c2dbc239dd4e91b46729d73a27fb57e9',2,1,'avoidable',0.0,0.0,0.01,0.02,NULL,0,0,'2026-11-29 15:14:46.827469','{"run_id":"run-0","status":"finished","verdicts":[{"oracle":"collision","ego":"ego_0","outcome":"violated","message":"","severity":"major","at_fault":true,"undetermined":false,"avoidable":null,"physically_avoidable":null,"time":0.0,"step":null,"location":[1.0,2.0],"counterpart":"","evidence":{"ego_speed":0.30000000000000004},"follows":""},{"oracle":"collision","ego":"ego_0","outcome":"violated","message":"","severity":"major","at_fault":null,"undetermined":false,"avoidable":null,"physically_avoidable":null,"time":1.0,"step":null,"location":[1.0,2.0],"counterpart":"","evidence":{"ego_speed":0.30000000000000004},"follows":""}],"metrics":{},"scores":{},"measurement":null,"trace_sha256":"7777777777777777777777777777777777777777777777777777777777777777","egos_sha256":"","without_effect":[],"steps":0,"sim_time_s":0.0,"wall_time_s":0.0,"step_cost_us":0.0,"agent_cost_us":{},"privileged":[],"failure":null,"agents":{},"versions":{}}',1);
INSERT INTO "evaluations" VALUES(1,1,0,'initial','[]','[0.1, 0.3333333333333333, -1e-17]','invalid',NULL,0,0,NULL,0.0,0.0,0.01,0.02,NULL,0,0,'2026-11-29 15:14:46.827469','{"run_id":"run-1","status":"invalid","verdicts":[],"metrics":{},"scores":{},"measurement":null,"trace_sha256":"","egos_sha256":"","without_effect":[],"steps":0,"sim_time_s":0.0,"wall_time_s":0.0,"step_cost_us":0.0,"agent_cost_us":{},"privileged":[],"failure":{"cause":"invalid_document","message":"too near","log":""},"agents":{},"versions":{}}',0);
INSERT INTO "evaluations" VALUES(1,2,1,'initial','[]','[0.2, 0.3333333333333333, -1e-17]','failed','d4735e3a265e16eee03f59718b9b5d03019c07d8b6c51f90da3a666eec13ab35',0,0,NULL,0.0,0.0,0.01,0.02,NULL,0,0,'2026-11-29 15:14:46.827469','{"run_id":"run-2","status":"finished","verdicts":[],"metrics":{},"scores":{},"measurement":null,"trace_sha256":"7777777777777777777777777777777777777777777777777777777777777777","egos_sha256":"","without_effect":[],"steps":0,"sim_time_s":0.0,"wall_time_s":0.0,"step_cost_us":0.0,"agent_cost_us":{},"privileged":[],"failure":null,"agents":{},"versions":{}}',0);
INSERT INTO "evaluations" VALUES(1,3,1,'mutation','[0]','[0.30000000000000004, 0.3333333333333333, -1e-17]','judged','4e07408562bedb8b60ce05c1decfe3ad16b72230967de01f640b7e4729b49fce',1,0,'not_at_fault',0.0,0.0,0.01,0.02,NULL,0,0,'2026-11-29 15:14:46.827469','{"run_id":"run-3","status":"finished","verdicts":[{"oracle":"collision","ego":"ego_0","outcome":"violated","message":"","severity":"major","at_fault":false,"undetermined":false,"avoidable":null,"physically_avoidable":null,"time":0.0,"step":null,"location":[1.0,2.0],"counterpart":"","evidence":{"ego_speed":0.30000000000000004},"follows":""}],"metrics":{},"scores":{},"measurement":null,"trace_sha256":"7777777777777777777777777777777777777777777777777777777777777777","egos_sha256":"","without_effect":[],"steps":0,"sim_time_s":0.0,"wall_time_s":0.0,"step_cost_us":0.0,"agent_cost_us":{},"privileged":[],"failure":null,"agents":{},"versions":{}}',1);
INSERT INTO "evaluations" VALUES(1,4,2,'mutation','[0]','[0.4, 0.3333333333333333, -1e-17]','judged','4b227777d4dd1fc61c6f884f48641d02b4d121d3fd328cb08b5531fcacdabf8a',1,1,'avoidable',0.0,0.0,0.01,0.02,NULL,0,0,'2026-11-29 15:14:46.827469','{"run_id":"run-4","status":"finished","verdicts":[{"oracle":"collision","ego":"ego_0","outcome":"violated","message":"","severity":"major","at_fault":true,"undetermined":false,"avoidable":null,"physically_avoidable":null,"time":0.0,"step":null,"location":[1.0,2.0],"counterpart":"","evidence":{"ego_speed":0.30000000000000004},"follows":""}],"metrics":{},"scores":{},"measurement":null,"trace_sha256":"7777777777777777777777777777777777777777777777777777777777777777","egos_sha256":"","without_effect":[],"steps":0,"sim_time_s":0.0,"wall_time_s":0.0,"step_cost_us":0.0,"agent_cost_us":{},"privileged":[],"failure":null,"agents":{},"versions":{}}',1);
INSERT INTO "evaluations" VALUES(1,5,2,'mutation','[0, 3]','[0.5, 0.3333333333333333, -1e-17]','judged','ef2d127de37b942baad06145e54b0c619a1f22327b2ebbcfbec78f5564afe39d',0,0,NULL,0.0,0.0,0.01,0.02,NULL,0,0,'2026-11-29 15:14:46.827469','{"run_id":"run-5","status":"finished","verdicts":[],"metrics":{},"scores":{},"measurement":null,"trace_sha256":"7777777777777777777777777777777777777777777777777777777777777777","egos_sha256":"","without_effect":[],"steps":0,"sim_time_s":0.0,"wall_time_s":0.0,"step_cost_us":0.0,"agent_cost_us":{},"privileged":[],"failure":null,"agents":{},"versions":{}}',0);
CREATE TABLE facets (
	"key" BIGINT NOT NULL, 
	agent VARCHAR(200) NOT NULL, 
	configuration VARCHAR(400) DEFAULT '' NOT NULL, 
	configuration_id VARCHAR(8) DEFAULT '' NOT NULL, 
	town VARCHAR(100) NOT NULL, 
	status VARCHAR(24) NOT NULL, 
	violated BOOLEAN, 
	accountability VARCHAR(16), 
	failing BOOLEAN, 
	runs INTEGER NOT NULL, 
	CONSTRAINT pk_facets PRIMARY KEY ("key")
);
INSERT INTO "facets" VALUES(2723149239750009280,'idm','idm','','tee-town','queued',NULL,NULL,NULL,1);
INSERT INTO "facets" VALUES(4027394518245958855,'krauss','krauss','','grid','queued',NULL,NULL,NULL,1);
INSERT INTO "facets" VALUES(727384556823528832,'krauss','krauss','','grid','cancelled',NULL,NULL,NULL,1);
INSERT INTO "facets" VALUES(2422866546981553484,'idm','idm','','tee-town','cancelled',NULL,NULL,NULL,1);
INSERT INTO "facets" VALUES(9189786221799453301,'idm','idm','','tee-town','running',NULL,NULL,NULL,4);
INSERT INTO "facets" VALUES(6402252806136511734,'idm','idm','','tee-town','finished',1,'avoidable',1,2);
INSERT INTO "facets" VALUES(8463407477753882159,'idm','idm','','tee-town','finished',0,NULL,0,5);
INSERT INTO "facets" VALUES(1126162244662291354,'idm','idm','','tee-town','simulator_crashed',NULL,NULL,NULL,2);
CREATE TABLE failure_group_changes (
	seq INTEGER NOT NULL, 
	group_seq INTEGER NOT NULL, 
	changed_at DATETIME NOT NULL, 
	changed_by VARCHAR(250) NOT NULL, 
	what VARCHAR(16) NOT NULL, 
	"before" TEXT NOT NULL, 
	"after" TEXT NOT NULL, 
	CONSTRAINT pk_failure_group_changes PRIMARY KEY (seq), 
	CONSTRAINT fk_failure_group_changes_group_seq_failure_groups FOREIGN KEY(group_seq) REFERENCES failure_groups (seq) ON DELETE CASCADE
);
CREATE TABLE failure_group_names (
	name VARCHAR(400) NOT NULL, 
	group_seq INTEGER NOT NULL, 
	CONSTRAINT pk_failure_group_names PRIMARY KEY (name), 
	CONSTRAINT fk_failure_group_names_group_seq_failure_groups FOREIGN KEY(group_seq) REFERENCES failure_groups (seq) ON DELETE CASCADE
);
CREATE TABLE failure_groups (
	seq INTEGER NOT NULL, 
	id VARCHAR(40) NOT NULL, 
	label VARCHAR(200) NOT NULL, 
	status VARCHAR(16) NOT NULL, 
	status_at DATETIME NOT NULL, 
	assignee VARCHAR(100) NOT NULL, 
	note TEXT NOT NULL, 
	changed_at DATETIME NOT NULL, 
	changed_by VARCHAR(250) NOT NULL, 
	into_seq INTEGER, 
	revision INTEGER NOT NULL, 
	CONSTRAINT pk_failure_groups PRIMARY KEY (seq), 
	CONSTRAINT uq_failure_groups_id UNIQUE (id), 
	CONSTRAINT fk_failure_groups_into_seq_failure_groups FOREIGN KEY(into_seq) REFERENCES failure_groups (seq) ON DELETE CASCADE
);
CREATE TABLE failure_kinds (
	campaign_seq INTEGER NOT NULL, 
	kind VARCHAR(400) NOT NULL, 
	failures INTEGER NOT NULL, 
	violations INTEGER NOT NULL, 
	at_fault INTEGER NOT NULL, 
	avoidable INTEGER NOT NULL, 
	confirmed INTEGER NOT NULL, 
	flaky INTEGER NOT NULL, 
	first INTEGER NOT NULL, 
	groups INTEGER NOT NULL, 
	CONSTRAINT pk_failure_kinds PRIMARY KEY (campaign_seq, kind), 
	CONSTRAINT fk_failure_kinds_campaign_seq_campaigns FOREIGN KEY(campaign_seq) REFERENCES campaigns (seq) ON DELETE CASCADE
);
INSERT INTO "failure_kinds" VALUES(1,'collision|road a',3,4,2,2,1,1,0,2);
CREATE TABLE failures (
	campaign_seq INTEGER NOT NULL, 
	number INTEGER NOT NULL, 
	place INTEGER NOT NULL, 
	oracle VARCHAR(60) NOT NULL, 
	kind VARCHAR(400) NOT NULL, 
	at_fault BOOLEAN, 
	accountability VARCHAR(16), 
	confirmation VARCHAR(16) NOT NULL, 
	group_number INTEGER, 
	trace TEXT NOT NULL, 
	verdict TEXT NOT NULL, 
	CONSTRAINT pk_failures PRIMARY KEY (campaign_seq, number, place), 
	CONSTRAINT fk_failures_campaign_seq_campaigns FOREIGN KEY(campaign_seq) REFERENCES campaigns (seq) ON DELETE CASCADE
);
INSERT INTO "failures" VALUES(1,0,0,'collision','collision|road a',1,'avoidable','confirmed',0,'000000.trace.parquet','{"oracle":"collision","ego":"ego_0","outcome":"violated","message":"","severity":"major","at_fault":true,"undetermined":false,"avoidable":null,"physically_avoidable":null,"time":0.0,"step":null,"location":[1.0,2.0],"counterpart":"","evidence":{"ego_speed":0.30000000000000004},"follows":""}');
INSERT INTO "failures" VALUES(1,0,1,'collision','collision|road a',NULL,'not_judged','confirmed',1,'000000.trace.parquet','{"oracle":"collision","ego":"ego_0","outcome":"violated","message":"","severity":"major","at_fault":null,"undetermined":false,"avoidable":null,"physically_avoidable":null,"time":1.0,"step":null,"location":[1.0,2.0],"counterpart":"","evidence":{"ego_speed":0.30000000000000004},"follows":""}');
INSERT INTO "failures" VALUES(1,3,0,'collision','collision|road a',0,'not_at_fault','flaky',NULL,'','{"oracle":"collision","ego":"ego_0","outcome":"violated","message":"","severity":"major","at_fault":false,"undetermined":false,"avoidable":null,"physically_avoidable":null,"time":0.0,"step":null,"location":[1.0,2.0],"counterpart":"","evidence":{"ego_speed":0.30000000000000004},"follows":""}');
INSERT INTO "failures" VALUES(1,4,0,'collision','collision|road a',1,'avoidable','open',0,'','{"oracle":"collision","ego":"ego_0","outcome":"violated","message":"","severity":"major","at_fault":true,"undetermined":false,"avoidable":null,"physically_avoidable":null,"time":0.0,"step":null,"location":[1.0,2.0],"counterpart":"","evidence":{"ego_speed":0.30000000000000004},"follows":""}');
CREATE TABLE found_failures (
	seq INTEGER NOT NULL, 
	found_at DATETIME NOT NULL, 
	campaign_seq INTEGER, 
	number INTEGER, 
	run_seq INTEGER, 
	batch_seq INTEGER, 
	place INTEGER NOT NULL, 
	oracle VARCHAR(60) NOT NULL, 
	group_name VARCHAR(400) NOT NULL, 
	group_seq INTEGER, 
	agent VARCHAR(200) NOT NULL, 
	configuration VARCHAR(400) DEFAULT '' NOT NULL, 
	configuration_id VARCHAR(8) DEFAULT '' NOT NULL, 
	town VARCHAR(100) NOT NULL, 
	at_fault BOOLEAN, 
	accountability VARCHAR(16), 
	is_counted BOOLEAN DEFAULT 1 NOT NULL, 
	is_violation BOOLEAN DEFAULT 1 NOT NULL, 
	confirmation VARCHAR(16) DEFAULT '' NOT NULL, 
	CONSTRAINT pk_found_failures PRIMARY KEY (seq), 
	CONSTRAINT fk_found_failures_campaign_seq_campaigns FOREIGN KEY(campaign_seq) REFERENCES campaigns (seq) ON DELETE CASCADE, 
	CONSTRAINT fk_found_failures_run_seq_runs FOREIGN KEY(run_seq) REFERENCES runs (seq) ON DELETE CASCADE
);
INSERT INTO "found_failures" VALUES(1,'2026-11-29 15:14:46.747518',NULL,NULL,2,1,1,'collision','collision',NULL,'idm','idm','','tee-town',1,'avoidable',1,1,'');
INSERT INTO "found_failures" VALUES(2,'2026-11-29 15:14:46.764254',NULL,NULL,5,2,1,'collision','collision',NULL,'idm','idm','','tee-town',1,'avoidable',1,1,'');
INSERT INTO "found_failures" VALUES(3,'2026-11-29 15:14:46.764254',NULL,NULL,5,2,2,'red_light','red_light',NULL,'idm','idm','','tee-town',1,'avoidable',1,1,'');
INSERT INTO "found_failures" VALUES(4,'2026-11-29 15:14:46.827469',1,0,NULL,NULL,0,'collision','collision',NULL,'idm','idm','','tee-town',1,'avoidable',1,1,'confirmed');
INSERT INTO "found_failures" VALUES(5,'2026-11-29 15:14:46.827469',1,0,NULL,NULL,1,'collision','collision',NULL,'idm','idm','','tee-town',NULL,'not_judged',1,1,'confirmed');
INSERT INTO "found_failures" VALUES(6,'2026-11-29 15:14:46.827469',1,3,NULL,NULL,0,'collision','collision',NULL,'idm','idm','','tee-town',0,'not_at_fault',1,1,'flaky');
INSERT INTO "found_failures" VALUES(7,'2026-11-29 15:14:46.827469',1,4,NULL,NULL,0,'collision','collision',NULL,'idm','idm','','tee-town',1,'avoidable',1,1,'open');
CREATE TABLE idempotency_keys (
	"key" VARCHAR(255) NOT NULL, 
	fingerprint VARCHAR(64) NOT NULL, 
	reference TEXT, 
	created_at DATETIME NOT NULL, 
	CONSTRAINT pk_idempotency_keys PRIMARY KEY ("key")
);
INSERT INTO "idempotency_keys" VALUES('key','ffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffff','01a227df7865643d9ef71013','2026-11-29 15:14:46.798265');
CREATE TABLE minimizations (
	seq INTEGER NOT NULL, 
	id VARCHAR(40) NOT NULL, 
	run_id VARCHAR(40) NOT NULL, 
	batch_id VARCHAR(40) NOT NULL, 
	owner_id VARCHAR(40) NOT NULL, 
	state VARCHAR(16) NOT NULL, 
	message TEXT NOT NULL, 
	failure TEXT NOT NULL, 
	budget INTEGER NOT NULL, 
	document TEXT NOT NULL, 
	progress TEXT NOT NULL, 
	created_at DATETIME NOT NULL, 
	started_at DATETIME, 
	ended_at DATETIME, 
	revision INTEGER NOT NULL, 
	CONSTRAINT pk_minimizations PRIMARY KEY (seq), 
	CONSTRAINT uq_minimizations_id UNIQUE (id)
);
CREATE TABLE owners (
	id VARCHAR(40) NOT NULL, 
	host VARCHAR(200) NOT NULL, 
	pid INTEGER NOT NULL, 
	started_at DATETIME NOT NULL, 
	heartbeat_at DATETIME NOT NULL, 
	ended_at DATETIME, 
	CONSTRAINT pk_owners PRIMARY KEY (id)
);
INSERT INTO "owners" VALUES('01a227df782d4fb20e34d336','vm',15154,'2026-11-29 15:14:46.445706','2026-11-29 15:14:46.445706',NULL);
INSERT INTO "owners" VALUES('01a227df78542cb301d9ccf1','vm',15154,'2026-11-29 15:14:46.484369','2026-11-29 15:14:46.484369','2026-11-29 15:14:46.796511');
CREATE TABLE quarantine (
	"key" VARCHAR(64) NOT NULL, 
	document_sha256 VARCHAR(64) NOT NULL, 
	run_id VARCHAR(40) NOT NULL, 
	cause VARCHAR(40) NOT NULL, 
	signal VARCHAR(16) NOT NULL, 
	message TEXT NOT NULL, 
	log TEXT NOT NULL, 
	created_at DATETIME NOT NULL, 
	CONSTRAINT pk_quarantine PRIMARY KEY ("key")
);
INSERT INTO "quarantine" VALUES('a00644508de97e85263c9d0cd67e63d3c3b5d733bcaddc65b110e501ad5a7b73','a00644508de97e85263c9d0cd67e63d3c3b5d733bcaddc65b110e501ad5a7b73','01a227df790acf8696eff2d9','signal','SIGSEGV','died of SIGSEGV','last line','2026-11-29 15:14:46.758523');
CREATE TABLE reports (
	run_seq INTEGER NOT NULL, 
	body TEXT NOT NULL, 
	candidate TEXT, 
	CONSTRAINT pk_reports PRIMARY KEY (run_seq), 
	CONSTRAINT fk_reports_run_seq_runs FOREIGN KEY(run_seq) REFERENCES runs (seq) ON DELETE CASCADE
);
INSERT INTO "reports" VALUES(1,'{"run_id":"01a227df7865643d9ef71013","status":"finished","verdicts":[{"oracle":"arrival","ego":"ego","outcome":"passed","message":"arrived","severity":"major","at_fault":null,"undetermined":false,"avoidable":null,"physically_avoidable":null,"time":null,"step":null,"location":null,"counterpart":"","evidence":{},"follows":""}],"metrics":{"speed":3.0,"gap":null},"scores":{},"measurement":null,"trace_sha256":"1111111111111111111111111111111111111111111111111111111111111111","egos_sha256":"","without_effect":[],"steps":10,"sim_time_s":0.0,"wall_time_s":0.0,"step_cost_us":0.0,"agent_cost_us":{},"privileged":[],"failure":null,"agents":{},"versions":{}}',NULL);
INSERT INTO "reports" VALUES(2,'{"run_id":"01a227df7865f0c54afda9bb","status":"finished","verdicts":[{"oracle":"arrival","ego":"ego","outcome":"passed","message":"arrived","severity":"major","at_fault":null,"undetermined":false,"avoidable":null,"physically_avoidable":null,"time":null,"step":null,"location":null,"counterpart":"","evidence":{},"follows":""},{"oracle":"collision","ego":"ego","outcome":"violated","message":"collision","severity":"major","at_fault":true,"undetermined":false,"avoidable":null,"physically_avoidable":null,"time":1.0,"step":null,"location":null,"counterpart":"","evidence":{},"follows":""}],"metrics":{"speed":3.0,"gap":null},"scores":{},"measurement":null,"trace_sha256":"","egos_sha256":"","without_effect":[],"steps":10,"sim_time_s":0.0,"wall_time_s":0.0,"step_cost_us":0.0,"agent_cost_us":{},"privileged":[],"failure":null,"agents":{},"versions":{}}',NULL);
INSERT INTO "reports" VALUES(4,'{"run_id":"01a227df790acf8696eff2d9","status":"simulator_crashed","verdicts":[],"metrics":{},"scores":{},"measurement":null,"trace_sha256":"","egos_sha256":"","without_effect":[],"steps":0,"sim_time_s":0.0,"wall_time_s":0.0,"step_cost_us":0.0,"agent_cost_us":{},"privileged":[],"failure":{"cause":"signal","message":"died of SIGSEGV","log":"last line"},"agents":{},"versions":{}}',NULL);
INSERT INTO "reports" VALUES(5,'{"run_id":"01a227df790aab06e91cca73","status":"finished","verdicts":[{"oracle":"arrival","ego":"ego","outcome":"passed","message":"arrived","severity":"major","at_fault":null,"undetermined":false,"avoidable":null,"physically_avoidable":null,"time":null,"step":null,"location":null,"counterpart":"","evidence":{},"follows":""},{"oracle":"collision","ego":"ego","outcome":"violated","message":"collision","severity":"major","at_fault":true,"undetermined":false,"avoidable":null,"physically_avoidable":null,"time":1.0,"step":null,"location":null,"counterpart":"","evidence":{},"follows":""},{"oracle":"red_light","ego":"ego","outcome":"violated","message":"red_light","severity":"major","at_fault":true,"undetermined":false,"avoidable":null,"physically_avoidable":null,"time":1.0,"step":null,"location":null,"counterpart":"","evidence":{},"follows":""}],"metrics":{"speed":3.0,"gap":null},"scores":{},"measurement":null,"trace_sha256":"","egos_sha256":"","without_effect":[],"steps":10,"sim_time_s":0.0,"wall_time_s":0.0,"step_cost_us":0.0,"agent_cost_us":{},"privileged":[],"failure":null,"agents":{},"versions":{}}',NULL);
INSERT INTO "reports" VALUES(7,'{"run_id":"01a227df790ae3d737e9c015","status":"finished","verdicts":[{"oracle":"arrival","ego":"ego","outcome":"passed","message":"arrived","severity":"major","at_fault":null,"undetermined":false,"avoidable":null,"physically_avoidable":null,"time":null,"step":null,"location":null,"counterpart":"","evidence":{},"follows":""}],"metrics":{"speed":3.0,"gap":null},"scores":{},"measurement":null,"trace_sha256":"","egos_sha256":"","without_effect":[],"steps":10,"sim_time_s":0.0,"wall_time_s":0.0,"step_cost_us":0.0,"agent_cost_us":{},"privileged":[],"failure":null,"agents":{},"versions":{}}',NULL);
INSERT INTO "reports" VALUES(8,'{"run_id":"01a227df790a22aacfc721d6","status":"finished","verdicts":[{"oracle":"arrival","ego":"ego","outcome":"passed","message":"arrived","severity":"major","at_fault":null,"undetermined":false,"avoidable":null,"physically_avoidable":null,"time":null,"step":null,"location":null,"counterpart":"","evidence":{},"follows":""}],"metrics":{"speed":3.0,"gap":null},"scores":{},"measurement":null,"trace_sha256":"","egos_sha256":"","without_effect":[],"steps":10,"sim_time_s":0.0,"wall_time_s":0.0,"step_cost_us":0.0,"agent_cost_us":{},"privileged":[],"failure":null,"agents":{},"versions":{}}',NULL);
INSERT INTO "reports" VALUES(9,'{"run_id":"01a227df790a8c77df73eb64","status":"finished","verdicts":[{"oracle":"arrival","ego":"ego","outcome":"passed","message":"arrived","severity":"major","at_fault":null,"undetermined":false,"avoidable":null,"physically_avoidable":null,"time":null,"step":null,"location":null,"counterpart":"","evidence":{},"follows":""}],"metrics":{"speed":3.0,"gap":null},"scores":{},"measurement":null,"trace_sha256":"","egos_sha256":"","without_effect":[],"steps":10,"sim_time_s":0.0,"wall_time_s":0.0,"step_cost_us":0.0,"agent_cost_us":{},"privileged":[],"failure":null,"agents":{},"versions":{}}',NULL);
INSERT INTO "reports" VALUES(10,'{"run_id":"01a227df790a8171fcd405a9","status":"finished","verdicts":[{"oracle":"arrival","ego":"ego","outcome":"passed","message":"arrived","severity":"major","at_fault":null,"undetermined":false,"avoidable":null,"physically_avoidable":null,"time":null,"step":null,"location":null,"counterpart":"","evidence":{},"follows":""}],"metrics":{"speed":3.0,"gap":null},"scores":{},"measurement":null,"trace_sha256":"","egos_sha256":"","without_effect":[],"steps":10,"sim_time_s":0.0,"wall_time_s":0.0,"step_cost_us":0.0,"agent_cost_us":{},"privileged":[],"failure":null,"agents":{},"versions":{}}',NULL);
INSERT INTO "reports" VALUES(15,'{"run_id":"01a227df791a53548e92bbf8","status":"cancelled","verdicts":[],"metrics":{},"scores":{},"measurement":null,"trace_sha256":"","egos_sha256":"","without_effect":[],"steps":0,"sim_time_s":0.0,"wall_time_s":0.0,"step_cost_us":0.0,"agent_cost_us":{},"privileged":[],"failure":{"cause":"cancelled","message":"the run was cancelled","log":""},"agents":{},"versions":{}}',NULL);
INSERT INTO "reports" VALUES(16,'{"run_id":"01a227df791ac138b9366311","status":"cancelled","verdicts":[],"metrics":{},"scores":{},"measurement":null,"trace_sha256":"","egos_sha256":"","without_effect":[],"steps":0,"sim_time_s":0.0,"wall_time_s":0.0,"step_cost_us":0.0,"agent_cost_us":{},"privileged":[],"failure":{"cause":"cancelled","message":"the run was cancelled","log":""},"agents":{},"versions":{}}',NULL);
INSERT INTO "reports" VALUES(17,'{"run_id":"01a227df7974acbbaaf03107","status":"simulator_crashed","verdicts":[],"metrics":{},"scores":{},"measurement":null,"trace_sha256":"","egos_sha256":"","without_effect":[],"steps":0,"sim_time_s":0.0,"wall_time_s":0.0,"step_cost_us":0.0,"agent_cost_us":{},"privileged":[],"failure":{"cause":"quarantined","message":"not run again: it crashed the simulator in run 01a227df790acf8696eff2d9 (died of SIGSEGV)","log":"last line"},"agents":{},"versions":{}}',NULL);
CREATE TABLE runs (
	seq INTEGER NOT NULL, 
	id VARCHAR(40) NOT NULL, 
	revision INTEGER NOT NULL, 
	batch_seq INTEGER NOT NULL, 
	item INTEGER NOT NULL, 
	label VARCHAR(200) NOT NULL, 
	document_sha256 VARCHAR(64) NOT NULL, 
	town VARCHAR(100) NOT NULL, 
	agent VARCHAR(200) NOT NULL, 
	configuration VARCHAR(400) DEFAULT '' NOT NULL, 
	configuration_id VARCHAR(8) DEFAULT '' NOT NULL, 
	agent_override VARCHAR(200) NOT NULL, 
	seed_override INTEGER, 
	definition TEXT DEFAULT '' NOT NULL, 
	feedback TEXT, 
	keeps_trace BOOLEAN DEFAULT 1 NOT NULL, 
	candidate TEXT, 
	status VARCHAR(24) NOT NULL, 
	cause VARCHAR(40) NOT NULL, 
	created_at DATETIME NOT NULL, 
	started_at DATETIME, 
	ended_at DATETIME, 
	cancel_requested BOOLEAN NOT NULL, 
	attempts INTEGER NOT NULL, 
	infrastructure_failures INTEGER NOT NULL, 
	crashes INTEGER NOT NULL, 
	interruptions INTEGER NOT NULL, 
	not_before DATETIME, 
	violations INTEGER, 
	at_fault_violations INTEGER, 
	observations INTEGER, 
	failures INTEGER, 
	accountability VARCHAR(16), 
	steps INTEGER, 
	sim_time_s DOUBLE, 
	wall_time_s DOUBLE, 
	trace_sha256 VARCHAR(64) NOT NULL, 
	facet BIGINT DEFAULT 0 NOT NULL, 
	CONSTRAINT pk_runs PRIMARY KEY (seq), 
	CONSTRAINT uq_runs_id UNIQUE (id), 
	CONSTRAINT fk_runs_batch_seq_batches FOREIGN KEY(batch_seq) REFERENCES batches (seq), 
	CONSTRAINT fk_runs_document_sha256_documents FOREIGN KEY(document_sha256) REFERENCES documents (sha256)
);
INSERT INTO "runs" VALUES(1,'01a227df7865643d9ef71013',34,1,0,'','a00644508de97e85263c9d0cd67e63d3c3b5d733bcaddc65b110e501ad5a7b73','tee-town','idm','idm','','',NULL,'',NULL,1,NULL,'finished','','2026-11-29 15:14:46.508285','2026-11-29 15:14:46.740244','2026-11-29 15:14:46.747496',0,1,0,0,0,NULL,0,0,0,0,NULL,10,0.0,0.0,'1111111111111111111111111111111111111111111111111111111111111111',8463407477753882159);
INSERT INTO "runs" VALUES(2,'01a227df7865f0c54afda9bb',35,1,1,'','cd80994abb0d1e0465acdc560717676578c1774f461babbe67b4b131497a6305','tee-town','idm','idm','','',NULL,'',NULL,1,NULL,'finished','','2026-11-29 15:14:46.508285','2026-11-29 15:14:46.740244','2026-11-29 15:14:46.747518',0,1,0,0,0,NULL,1,1,0,1,'avoidable',10,0.0,0.0,'',6402252806136511734);
INSERT INTO "runs" VALUES(3,'01a227df7865995db7d0d1c9',32,1,2,'','f5e1420e13fd6cca6b2b875d53d06576439e4afec75fcc4a98d7b3b69b10b17e','tee-town','idm','idm','','',NULL,'',NULL,1,NULL,'running','','2026-11-29 15:14:46.508285','2026-11-29 15:14:46.740244',NULL,0,1,0,0,0,NULL,NULL,NULL,NULL,NULL,NULL,NULL,NULL,NULL,'',9189786221799453301);
INSERT INTO "runs" VALUES(4,'01a227df790acf8696eff2d9',51,2,0,'','a00644508de97e85263c9d0cd67e63d3c3b5d733bcaddc65b110e501ad5a7b73','tee-town','idm','idm','','',NULL,'',NULL,1,NULL,'simulator_crashed','signal','2026-11-29 15:14:46.666918','2026-11-29 15:14:46.752697','2026-11-29 15:14:46.756647',0,2,0,2,0,NULL,NULL,NULL,NULL,NULL,NULL,NULL,NULL,NULL,'',1126162244662291354);
INSERT INTO "runs" VALUES(5,'01a227df790aab06e91cca73',54,2,1,'','cd80994abb0d1e0465acdc560717676578c1774f461babbe67b4b131497a6305','tee-town','idm','idm','','',NULL,'',NULL,1,NULL,'finished','','2026-11-29 15:14:46.666918','2026-11-29 15:14:46.752697','2026-11-29 15:14:46.764254',0,1,0,0,0,NULL,2,2,0,2,'avoidable',10,0.0,0.0,'',6402252806136511734);
INSERT INTO "runs" VALUES(6,'01a227df790a06c473b1b041',67,2,2,'','f5e1420e13fd6cca6b2b875d53d06576439e4afec75fcc4a98d7b3b69b10b17e','tee-town','idm','idm','','',NULL,'',NULL,1,NULL,'running','','2026-11-29 15:14:46.666918','2026-11-29 15:14:46.752697',NULL,0,2,1,0,0,NULL,NULL,NULL,NULL,NULL,NULL,NULL,NULL,NULL,'',9189786221799453301);
INSERT INTO "runs" VALUES(7,'01a227df790ae3d737e9c015',56,2,3,'','c7401b91208af75ed9bdf943e87800172f9871b7662e0d30952e12ce41432b42','tee-town','idm','idm','','',NULL,'',NULL,1,NULL,'finished','','2026-11-29 15:14:46.666918','2026-11-29 15:14:46.752697','2026-11-29 15:14:46.765936',0,1,0,0,0,NULL,0,0,0,0,NULL,10,0.0,0.0,'',8463407477753882159);
INSERT INTO "runs" VALUES(8,'01a227df790a22aacfc721d6',57,2,4,'','79bc9b3597a171a403b40fdc3ce66d411aa88ffdf527e2766465408430cfda51','tee-town','idm','idm','','',NULL,'',NULL,1,NULL,'finished','','2026-11-29 15:14:46.666918','2026-11-29 15:14:46.752697','2026-11-29 15:14:46.765950',0,1,0,0,0,NULL,0,0,0,0,NULL,10,0.0,0.0,'',8463407477753882159);
INSERT INTO "runs" VALUES(9,'01a227df790a8c77df73eb64',58,2,5,'','caf8b22a0011849577800b93050eeca10cca7b856c90bcc5b2200ce21ed1ec22','tee-town','idm','idm','','',NULL,'',NULL,1,NULL,'finished','','2026-11-29 15:14:46.666918','2026-11-29 15:14:46.752697','2026-11-29 15:14:46.765958',0,1,0,0,0,NULL,0,0,0,0,NULL,10,0.0,0.0,'',8463407477753882159);
INSERT INTO "runs" VALUES(10,'01a227df790a8171fcd405a9',59,2,6,'','bcd69d66128edb57808dbd5522ef9f1a82acc53a5211bf8936ab7e90e501afb4','tee-town','idm','idm','','',NULL,'',NULL,1,NULL,'finished','','2026-11-29 15:14:46.666918','2026-11-29 15:14:46.752697','2026-11-29 15:14:46.765967',0,1,0,0,0,NULL,0,0,0,0,NULL,10,0.0,0.0,'',8463407477753882159);
INSERT INTO "runs" VALUES(11,'01a227df790ad61797220235',65,2,7,'','d56a5b5f9f0826672864fbd0f06a3c4b221a1be6350097ba49eb555128767fda','tee-town','idm','idm','','',NULL,'',NULL,1,NULL,'running','','2026-11-29 15:14:46.666918','2026-11-29 15:14:46.752697',NULL,1,1,0,0,0,NULL,NULL,NULL,NULL,NULL,NULL,NULL,NULL,NULL,'',9189786221799453301);
INSERT INTO "runs" VALUES(12,'01a227df790a36d3c5c56a27',45,2,8,'','8ffab84f301293229d1be75efb0dca213eb538579de22b842b941f7363090616','tee-town','idm','idm','','',NULL,'',NULL,1,NULL,'running','','2026-11-29 15:14:46.666918','2026-11-29 15:14:46.752697',NULL,0,1,0,0,0,NULL,NULL,NULL,NULL,NULL,NULL,NULL,NULL,NULL,'',9189786221799453301);
INSERT INTO "runs" VALUES(13,'01a227df79186a2093005fa1',19,3,0,'','a00644508de97e85263c9d0cd67e63d3c3b5d733bcaddc65b110e501ad5a7b73','tee-town','idm','idm','','',NULL,'',NULL,1,NULL,'queued','','2026-11-29 15:14:46.681346',NULL,NULL,0,0,0,0,0,NULL,NULL,NULL,NULL,NULL,NULL,NULL,NULL,NULL,'',2723149239750009280);
INSERT INTO "runs" VALUES(14,'01a227df791826f048998ac1',20,3,1,'','0f2a693e93e2ed7008feb5b7714bbab236e3907e64188199e3be1ae367f49c40','grid','krauss','krauss','','',NULL,'',NULL,1,NULL,'queued','','2026-11-29 15:14:46.681346',NULL,NULL,0,0,0,0,0,NULL,NULL,NULL,NULL,NULL,NULL,NULL,NULL,NULL,'',4027394518245958855);
INSERT INTO "runs" VALUES(15,'01a227df791a53548e92bbf8',29,4,0,'','a00644508de97e85263c9d0cd67e63d3c3b5d733bcaddc65b110e501ad5a7b73','tee-town','idm','idm','','',NULL,'',NULL,1,NULL,'cancelled','cancelled','2026-11-29 15:14:46.683164',NULL,'2026-11-29 15:14:46.693026',0,0,0,0,0,NULL,NULL,NULL,NULL,NULL,NULL,NULL,NULL,NULL,'',2422866546981553484);
INSERT INTO "runs" VALUES(16,'01a227df791ac138b9366311',27,4,1,'','0f2a693e93e2ed7008feb5b7714bbab236e3907e64188199e3be1ae367f49c40','grid','krauss','krauss','','',NULL,'',NULL,1,NULL,'cancelled','cancelled','2026-11-29 15:14:46.683164',NULL,'2026-11-29 15:14:46.693026',0,0,0,0,0,NULL,NULL,NULL,NULL,NULL,NULL,NULL,NULL,NULL,'',727384556823528832);
INSERT INTO "runs" VALUES(17,'01a227df7974acbbaaf03107',63,1,0,'','a00644508de97e85263c9d0cd67e63d3c3b5d733bcaddc65b110e501ad5a7b73','tee-town','idm','idm','','',NULL,'',NULL,1,NULL,'simulator_crashed','quarantined','2026-11-29 15:14:46.772951',NULL,'2026-11-29 15:14:46.772951',0,0,0,0,0,NULL,NULL,NULL,NULL,NULL,NULL,NULL,NULL,NULL,'',1126162244662291354);
CREATE TABLE slots (
	owner_id VARCHAR(40) NOT NULL, 
	name VARCHAR(100) NOT NULL, 
	pid INTEGER, 
	run_id VARCHAR(40) NOT NULL, 
	phase VARCHAR(16) NOT NULL, 
	step INTEGER NOT NULL, 
	memory_bytes INTEGER NOT NULL, 
	runs INTEGER NOT NULL, 
	restarts INTEGER NOT NULL, 
	last_crash TEXT NOT NULL, 
	updated_at DATETIME NOT NULL, 
	since DATETIME, 
	last_crash_at DATETIME, 
	CONSTRAINT pk_slots PRIMARY KEY (owner_id, name), 
	CONSTRAINT fk_slots_owner_id_owners FOREIGN KEY(owner_id) REFERENCES owners (id) ON DELETE CASCADE
);
CREATE TABLE studies (
	seq INTEGER NOT NULL, 
	id VARCHAR(40) NOT NULL, 
	name VARCHAR(200) NOT NULL, 
	document TEXT NOT NULL, 
	request VARCHAR(16) NOT NULL, 
	created_at DATETIME NOT NULL, 
	revision INTEGER DEFAULT 0 NOT NULL, 
	CONSTRAINT pk_studies PRIMARY KEY (seq), 
	CONSTRAINT uq_studies_id UNIQUE (id)
);
CREATE TABLE suite_outcomes (
	run_seq INTEGER NOT NULL, 
	place INTEGER NOT NULL, 
	scenario VARCHAR(400) NOT NULL, 
	state VARCHAR(24) NOT NULL, 
	failing INTEGER NOT NULL, 
	judged INTEGER NOT NULL, 
	score DOUBLE, 
	run_id VARCHAR(40) NOT NULL, 
	failures TEXT NOT NULL, 
	CONSTRAINT pk_suite_outcomes PRIMARY KEY (run_seq, place), 
	CONSTRAINT fk_suite_outcomes_run_seq_suite_runs FOREIGN KEY(run_seq) REFERENCES suite_runs (seq) ON DELETE CASCADE
);
CREATE TABLE suite_runs (
	seq INTEGER NOT NULL, 
	id VARCHAR(40) NOT NULL, 
	suite VARCHAR(200) NOT NULL, 
	agent VARCHAR(200) NOT NULL, 
	configuration_id VARCHAR(8) DEFAULT '' NOT NULL, 
	created_at DATETIME NOT NULL, 
	fails BOOLEAN NOT NULL, 
	scenarios INTEGER NOT NULL, 
	passing INTEGER NOT NULL, 
	body TEXT NOT NULL, 
	revision INTEGER NOT NULL, 
	CONSTRAINT pk_suite_runs PRIMARY KEY (seq), 
	CONSTRAINT uq_suite_runs_id UNIQUE (id)
);
CREATE TABLE verdicts (
	seq INTEGER NOT NULL, 
	run_seq INTEGER NOT NULL, 
	oracle VARCHAR(60) NOT NULL, 
	ego VARCHAR(200) NOT NULL, 
	outcome VARCHAR(16) NOT NULL, 
	severity VARCHAR(16), 
	at_fault BOOLEAN, 
	accountability VARCHAR(16), 
	time DOUBLE, 
	counterpart VARCHAR(200) NOT NULL, 
	batch_seq INTEGER DEFAULT 0 NOT NULL, 
	facet BIGINT DEFAULT 0 NOT NULL, 
	CONSTRAINT pk_verdicts PRIMARY KEY (seq), 
	CONSTRAINT fk_verdicts_run_seq_runs FOREIGN KEY(run_seq) REFERENCES runs (seq) ON DELETE CASCADE
);
INSERT INTO "verdicts" VALUES(1,2,'collision','ego','violated','major',1,'avoidable',1.0,'',1,6402252806136511734);
INSERT INTO "verdicts" VALUES(2,5,'collision','ego','violated','major',1,'avoidable',1.0,'',2,6402252806136511734);
INSERT INTO "verdicts" VALUES(3,5,'red_light','ego','violated','major',1,'avoidable',1.0,'',2,6402252806136511734);
CREATE INDEX ix_idempotency_keys_created_at ON idempotency_keys (created_at);
CREATE INDEX ix_campaigns_study ON campaigns (study_id, state, seq);
CREATE INDEX ix_campaigns_revision ON campaigns (revision);
CREATE INDEX ix_campaigns_batch ON campaigns (batch_id) WHERE batch_id != '';
CREATE INDEX ix_campaigns_state ON campaigns (state, seq);
CREATE INDEX ix_studies_revision ON studies (revision);
CREATE INDEX ix_failure_groups_into_seq ON failure_groups (into_seq);
CREATE INDEX ix_failure_groups_revision ON failure_groups (revision);
CREATE INDEX ix_minimizations_revision ON minimizations (revision);
CREATE INDEX ix_minimizations_active ON minimizations (owner_id, seq) WHERE state IN ('queued', 'running');
CREATE INDEX ix_minimizations_run ON minimizations (run_id, seq);
CREATE INDEX ix_batches_owner ON batches (owner_id) WHERE owner_id != '';
CREATE INDEX ix_batches_revision ON batches (revision);
CREATE INDEX ix_batches_priority ON batches (priority, seq);
CREATE INDEX ix_batches_claimable ON batches (priority, served, seq) WHERE queued > 0 AND state = 'open';
CREATE INDEX ix_quarantine_document_sha256 ON quarantine (document_sha256);
CREATE INDEX ix_suite_runs_suite ON suite_runs (suite, seq);
CREATE INDEX ix_suite_runs_revision ON suite_runs (revision);
CREATE INDEX ix_evaluations_document_sha256 ON evaluations (document_sha256);
CREATE INDEX ix_evaluations_status ON evaluations (campaign_seq, status, violating, number);
CREATE INDEX ix_evaluations_violating ON evaluations (campaign_seq, number) WHERE violations > 0;
CREATE INDEX ix_evaluations_generation ON evaluations (campaign_seq, generation, status, violating, number);
CREATE INDEX ix_failures_filters ON failures (campaign_seq, number, place, oracle, kind, at_fault, accountability, confirmation);
CREATE INDEX ix_failure_group_names_group_seq ON failure_group_names (group_seq);
CREATE INDEX ix_failure_group_changes_group ON failure_group_changes (group_seq, seq);
CREATE INDEX ix_runs_ended ON runs (ended_at) WHERE ended_at IS NOT NULL;
CREATE INDEX ix_runs_to_cancel ON runs (seq) WHERE status = 'running' AND cancel_requested;
CREATE INDEX ix_runs_revision ON runs (revision);
CREATE INDEX ix_runs_held ON runs (not_before, status) WHERE not_before IS NOT NULL;
CREATE INDEX ix_runs_document_facet ON runs (document_sha256, facet, seq);
CREATE INDEX ix_runs_queued ON runs (batch_seq, seq) WHERE status = 'queued';
CREATE INDEX ix_runs_batch_facet ON runs (batch_seq, facet, seq);
CREATE INDEX ix_runs_facet ON runs (facet, seq);
CREATE INDEX ix_verdicts_run_seq ON verdicts (run_seq);
CREATE INDEX ix_verdicts_facet ON verdicts (oracle, outcome, at_fault, facet, run_seq);
CREATE INDEX ix_verdicts_batch_facet ON verdicts (batch_seq, oracle, outcome, at_fault, facet, run_seq);
CREATE INDEX ix_attempts_leases ON attempts (owner_id) WHERE ended_at IS NULL;
CREATE INDEX ix_found_failures_run ON found_failures (run_seq);
CREATE INDEX ix_found_failures_group ON found_failures (group_name, group_seq, accountability, campaign_seq, town, oracle, agent, at_fault, confirmation, batch_seq, found_at, configuration_id, is_counted, is_violation);
CREATE INDEX ix_found_failures_group_seq ON found_failures (group_seq);
CREATE INDEX ix_found_failures_campaign ON found_failures (campaign_seq, number, place);
COMMIT;
